#pragma once
#include "base/matrix.hpp"

namespace doseki {

// Eq. (83). A deformation gradient is a fit to the places of neighbours; what it misses, r_ij - F_i
// R_ij, may grow unseen by any stress. Springs of stiffness kappa [Pa] with the weights of that
// fit, -V_j F(R), pull it back (Ganzenmueller, Comput. Methods Appl. Mech. Eng. 286, 2015; Silling,
// ibid. 322, 2017). The fit being the one of least squares with these very weights, the energy of
// the springs does not change with F_i to first order: their force is its exact gradient, and keeps
// momentum, angular momentum and energy.

/// What a point brings to both sums of a pair: stress less springs.
template <class T, int D>
DOSEKI_FN Mat<T, D> less_springs(const Mat<T, D>& stress, const T& kappa, const Mat<T, D>& F) {
    return stress - kappa * F;
}

/// Eq. (83): force on i of a pair over V_i V_j F(R), (Q_i + Q_j) R_ij + (kappa_i + kappa_j) r_ij,
/// with Q of less_springs.
template <class T, int D>
DOSEKI_FN Vec<T, D> elastic_pair_force(const Mat<T, D>& Q_i, const Mat<T, D>& Q_j,
                                       const T& kappa_sum, const Vec<T, D>& R_ij,
                                       const Vec<T, D>& r_ij) {
    return (Q_i + Q_j) * R_ij + kappa_sum * r_ij;
}

}  // namespace doseki
