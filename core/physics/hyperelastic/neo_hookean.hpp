#pragma once
#include <cmath>

#include "physics/hyperelastic/strain.hpp"

namespace doseki {

/// Eq. (81), P = mu (F - F^-T) + lambda ln(J) F^-T: compressible neo-Hookean law (Bonet and Wood,
/// Nonlinear Continuum Mechanics for Finite Element Analysis, 1997). Compression to nothing takes
/// infinite work, which St Venant-Kirchhoff's law does not ask.
template <class T>
struct NeoHookean {
    static constexpr const char* name = "neo_hookean";

    Lame<T> lame{};

    template <class F>
    void members(F&& f) {
        f("lambda", lame.lambda), f("mu", lame.mu);
    }

    /// First Piola-Kirchhoff stress.
    template <int D>
    DOSEKI_FN Mat<T, D> stress(const Mat<T, D>& F) const {
        using std::log;
        const Mat<T, D> c = cofactors(F);
        const T J = determinant(F, c);
        return lame.mu * F + ((lame.lambda * log(J) - lame.mu) / J) * c;
    }

    /// Energy per volume at rest, mu (tr F^T F - D)/2 - mu ln J + lambda ln^2(J)/2.
    template <int D>
    DOSEKI_FN T energy(const Mat<T, D>& F) const {
        using std::log;
        T square = T(-D);
        for (const T& element : F.element) square += element * element;
        const T log_J = log(determinant(F));
        return number<T>(0.5) * lame.mu * square - lame.mu * log_J +
               number<T>(0.5) * lame.lambda * log_J * log_J;
    }

    /// Cauchy stress along z in plane strain.
    DOSEKI_FN T stress_across(const Mat<T, 2>& F) const {
        using std::log;
        const T J = determinant(F);
        return lame.lambda * log(J) / J;
    }

    /// Bound on how many times faster waves are than at rest.
    template <int D>
    double stiffening(const Mat<double, D>& F) const {
        const double J = determinant(F);
        return J < 1.0 ? std::sqrt(1.0 - std::log(J)) / J : 1.0;
    }
};

}  // namespace doseki
