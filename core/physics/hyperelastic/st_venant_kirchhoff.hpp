#pragma once
#include <algorithm>
#include <cmath>

#include "physics/hyperelastic/strain.hpp"

namespace doseki {

/// Eq. (81), P = F S, S = lambda tr(E) 1 + 2 mu E with Green's strain E.
template <class T>
struct StVenantKirchhoff {
    static constexpr const char* name = "st_venant_kirchhoff";

    Lame<T> lame{};

    template <class F>
    void members(F&& f) {
        f("lambda", lame.lambda), f("mu", lame.mu);
    }

    /// First Piola-Kirchhoff stress.
    template <int D>
    DOSEKI_FN Mat<T, D> stress(const Mat<T, D>& F) const {
        const Sym<T, D> strain = green_strain(F);
        T sum = strain(0, 0);
        for (int a = 1; a < D; ++a) sum += strain(a, a);
        Mat<T, D> S = (T(2) * lame.mu) * full(strain);
        for (int a = 0; a < D; ++a) S(a, a) += lame.lambda * sum;
        return F * S;
    }

    /// Energy per volume at rest, lambda tr(E)^2/2 + mu E:E.
    template <int D>
    DOSEKI_FN T energy(const Mat<T, D>& F) const {
        const Sym<T, D> strain = green_strain(F);
        T sum = strain(0, 0), square = T(0);
        for (int a = 1; a < D; ++a) sum += strain(a, a);
        for (int a = 0; a < D; ++a)
            for (int b = 0; b < D; ++b)
                square += strain(min(a, b), max(a, b)) * strain(min(a, b), max(a, b));
        return number<T>(0.5) * lame.lambda * sum * sum + lame.mu * square;
    }

    /// Cauchy stress along z in plane strain.
    DOSEKI_FN T stress_across(const Mat<T, 2>& F) const {
        const Sym<T, 2> strain = green_strain(F);
        return lame.lambda * (strain(0, 0) + strain(1, 1)) / determinant(F);
    }

    /// Bound on how many times faster waves are than at rest.
    template <int D>
    double stiffening(const Mat<double, D>& F) const {
        double stretch = 0.0;  // squared
        for (int a = 0; a < D; ++a) {
            double length = 0.0;
            for (int b = 0; b < D; ++b) length += F(b, a) * F(b, a);
            stretch = std::max(stretch, length);
        }
        return std::sqrt(std::max(1.0, 0.5 * (3.0 * stretch - 1.0)));
    }
};

}  // namespace doseki
