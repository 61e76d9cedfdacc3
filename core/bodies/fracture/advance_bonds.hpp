#pragma once
// How cracks begin, open, close and end.

#include "bodies/fracture/bonds.hpp"
#include "physics/fracture.hpp"
#include "physics/hyperelastic/strain.hpp"

namespace doseki {

template <int D>
void Bonds<D>::index(std::size_t points) {
    first_bond_.assign(points + 1, 0);
    for (std::size_t n = 1; n < size(); ++n)
        ++first_bond_[pairs_[n].a + 1], ++first_bond_[pairs_[n].b + 1];
    for (std::size_t p = 0; p < points; ++p) first_bond_[p + 1] += first_bond_[p];
    bond_.assign(first_bond_[points], 0);
    Array<std::size_t> next(first_bond_.begin(), first_bond_.end());
    for (std::size_t n = 1; n < size(); ++n)
        for (const std::uint32_t p : {pairs_[n].a, pairs_[n].b})
            bond_[next[p]++] = static_cast<std::uint32_t>(n);
}

template <int D>
void Bonds<D>::add_code(std::size_t p, std::size_t points, std::uint32_t j) {
    std::uint32_t code = 0;
    if (p < points)
        for (std::size_t k = first_bond_[p]; k < first_bond_[p + 1]; ++k) {
            const Ends& ends = pairs_[bond_[k]];
            if (ends.a == p && ends.b == j) code = 2 * bond_[k];
            if (ends.b == p && ends.a == j) code = 2 * bond_[k] + 1;
        }
    code_.push_back(code);
}

/// Second Piola-Kirchhoff stress: of the material, so that it does not turn.
template <int D>
Sym<double, D> material_stress(const BondPoint<D>& point) {
    if (!point.spans) return {};
    return symmetric_part(inverse(point.F, 0.0) * point.P);
}

/// Energy per weight that point i gives up when the vector R of a bond to it changes, Eq. (109).
template <int D>
double Bonds<D>::released(const BondPoint<D>& i, const Vec<double, D>& R, const Vec<double, D>& r,
                          const Vec<double, D>& change) {
    if (!i.spans) return 0.0;
    const Mat<double, D> S = i.P * transposed(i.B);
    const Vec<double, D> misfit = r - i.F * R;
    return dot(i.F * change, S * R + i.kappa * misfit) - dot(misfit, S * change);
}

/// The same when the bond stops to count.
template <int D>
double Bonds<D>::lost(const BondPoint<D>& i, const Vec<double, D>& R, const Vec<double, D>& r) {
    if (!i.spans) return 0.0;
    const Vec<double, D> misfit = r - i.F * R;
    return dot(misfit, (i.P * transposed(i.B)) * R) + 0.5 * i.kappa * dot(misfit, misfit);
}

template <int D>
CrackSite Bonds<D>::site(std::size_t n, const Vec<double, D>& normal, const Two& two,
                         const DeformableBody& body) const {
    const double c = body.wave_speed(), stiffness = body.rho0 * c * c / body.spacing;
    const double along = dot(normal, two.R());
    // Shares of bonds of the volume of a point: with these, all those across a direction have all.
    const double volume = two.weight * 2.0 * two.a.volume * two.b.volume * along * along;
    const double radius = (D == 2 ? 0.564 : 0.620) * body.spacing;  // of a ball of that volume
    const std::uint64_t key = (std::uint64_t{pairs_[n].a} << 32) | pairs_[n].b;
    return {stiffness, body.young_modulus(), volume, body.crack_speed * c / radius, key, body.seed};
}

template <int D>
bool Bonds<D>::begin(BondState<D>& s, std::size_t n, const Two& two, const DeformableBody& body,
                     const Sym<double, D>& stress) {
    double square = 0.0;
    for (const double element : full(stress).element) square += element * element;
    if (!(square > 0.0)) return false;
    const auto [tension, normal] = largest_principal(stress);
    if (!(tension > 0.0)) return false;
    const Vec<double, D> R = two.R();
    const double along = dot(normal, R);
    if (std::abs(along) < least_crossing * norm(R)) return false;
    const CrackSite place = site(n, normal, two, body);
    if (!with_value(body.law->fracture,
                    [&](const auto& law) { return law.starts(tension, place); }))
        return false;
    s.normal = along > 0.0 ? normal : -1.0 * normal;
    return true;
}

/// An open bond: its sides may have come back together, wherever along each other they are.
template <int D>
BondChange Bonds<D>::meet(BondState<D>& s, const Two& two) {
    if (!two.a.spans || !two.b.spans) return {};
    const Vec<double, D> R = two.R();
    const Vec<double, D> gap = inverse(two.mean_deformation(), 0.0) * two.r() - R;
    const double width = dot(gap, s.normal);
    if (norm(gap) > reach * norm(R)) {
        part(s);
        return {};
    }
    if (width > 0.0) return {};
    s.jump = gap - width * s.normal, s.opening = 0.0, s.whole = 1.0;
    return {0.0, 0, 1};
}

template <int D>
BondChange Bonds<D>::step(std::size_t n, double dt, const Two& two, const DeformableBody& body) {
    BondState<D>& s = state_[n];
    if (s.parted != 0.0) return {};
    if (s.whole == 0.0) return meet(s, two);
    const Sym<double, D> stress = symmetric_part(
        0.5 * (full(material_stress(two.a)) + full(material_stress(two.b))));
    if (!s.cracked() && !begin(s, n, two, body, stress)) return {};

    const CrackSite place = site(n, s.normal, two, body);
    const double tension = dot(s.normal, stress * s.normal);
    const Vec<double, D> R = two.R() + s.jump, r = two.r();
    const double share = two.weight * two.a.volume * two.b.volume;
    Crack crack{s.opening, s.max_opening, s.damage};
    BondChange change;
    with_value(body.law->fracture, [&](const auto& law) {
        const bool had_failed = law.failed(crack);
        if (had_failed && tension > 0.0) {
            s.whole = 0.0;
            change = {share * (lost(two.a, R, r) + lost(two.b, R, r)), 0, 1};
            return;
        }
        law.grow(crack, tension, dt, place);
        const double excess = had_failed ? tension : tension - law.traction(crack, place),
                     slope = had_failed ? 0.0 : law.slope(crack, tension, place);
        crack.opening = max(
            0.0, crack.opening + relaxation * excess / (place.stiffness + slope));
        crack.max_opening = max(crack.max_opening, crack.opening);
        law.grow(crack, 0.0, 0.0, place);
        const Vec<double, D> widening = (crack.opening - s.opening) * s.normal;
        change.work = share * (released(two.a, R, r, widening) + released(two.b, R, r, widening));
        change.broken = !had_failed && law.failed(crack);
        s.jump = s.jump + widening;
    });
    s.opening = crack.opening, s.max_opening = crack.max_opening, s.damage = crack.damage;
    return change;
}

template <int D>
template <class Point, class Body>
void Bonds<D>::advance(double dt, const Point& point, const Body& body) {
    change_ = reduce(size() - 1, BondChange{}, std::plus<BondChange>{}, [&](std::size_t k) {
        const std::size_t n = k + 1;
        const Ends& ends = pairs_[n];
        if (state_[n].parted != 0.0) return BondChange{};
        return step(n, dt, {point(ends.a), point(ends.b), ends.weight}, body(ends.a));
    });
    work_ += change_.work, broken_ += change_.broken;
}

}  // namespace doseki
