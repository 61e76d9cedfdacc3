#pragma once

namespace doseki {

/// What a material brings into a contact; of a pair, the means of restitution and of the frictions
/// count.
struct ContactProperties {
    double restitution;
    double friction, rolling_friction;    // coefficients
    double young_modulus, poisson_ratio;  // [Pa]

    template <class F>
    void members(F&& f) {
        f("restitution", restitution);
        f("friction", friction), f("rolling_friction", rolling_friction);
        f("young_modulus", young_modulus), f("poisson_ratio", poisson_ratio);
    }
    /// (1 - nu^2)/E; none of what has no modulus.
    double compliance() const {
        return young_modulus > 0.0 ? (1.0 - poisson_ratio * poisson_ratio) / young_modulus : 0.0;
    }
};

/// E* of two materials that touch.
inline double contact_modulus(const ContactProperties& a, const ContactProperties& b) {
    return 1.0 / (a.compliance() + b.compliance());
}

}  // namespace doseki
