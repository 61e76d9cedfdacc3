#pragma once
#include <cstdint>
#include <string>

#include "base/array.hpp"
#include "cells/sweeps.hpp"
#include "model/archive.hpp"
#include "model/particles.hpp"

namespace doseki {

/// Mass [kg] and volume [m^3] of particles; 2-D: per metre.
struct MassAndVolume {
    double mass = 0.0, volume = 0.0;

    DOSEKI_DEVICE_FN MassAndVolume operator+(const MassAndVolume& other) const {
        return {mass + other.mass, volume + other.volume};
    }
};

/// A plane that sees each particle that goes through it: what has passed does not follow from what
/// is left on either side, so that the two can be held against each other.
template <int D>
struct CountingPlane {
    Vec<double, D> point{}, normal{};  // the normal, of length 1, points downstream

    // Since the start, of the particles of this rank.
    MassAndVolume passed;   // downstream, less what came back
    double supplied = 0.0;  // mass that came upstream other than through it, less what left there

    DOSEKI_DEVICE_FN bool is_beyond(const Vec<double, D>& x) const {
        return dot(x - point, normal) >= 0.0;
    }

    /// Notes on which side the particles are.
    void look(const Particles<D>& particles);
    /// What has changed sides since the last look, downstream less upstream; the order of the
    /// particles is that of then.
    MassAndVolume changed(const Particles<D>& particles);

    void enters(const Particles<D>& particles, std::size_t p) {
        if (!is_beyond(particles.position[p])) supplied += particles.mass[p];
    }
    void leaves(const Particles<D>& particles, std::size_t p) {
        if (!is_beyond(particles.position[p])) supplied -= particles.mass[p];
    }

    void serialise(Archive& archive) {
        archive("plane_mass", passed.mass), archive("plane_volume", passed.volume);
        archive("plane_supplied", supplied);
    }

private:
    Array<std::uint8_t> beyond_;
};

/// All planes of a run.
template <int D>
struct CountingPlanes : Array<CountingPlane<D>> {
    /// Before particles are moved, which `count` is called after.
    void look(const Particles<D>& particles) {
        for (CountingPlane<D>& plane : *this) plane.look(particles);
    }
    /// After a step of positions.
    void count(const Particles<D>& particles) {
        for (CountingPlane<D>& plane : *this)
            plane.passed = plane.passed + plane.changed(particles);
    }
    /// Takes particles to their images inside the domain: they go through no plane between.
    void wrap(Particles<D>& particles, const Domain<D>& domain) {
        look(particles);
        wrap_positions(particles, domain);
        for (CountingPlane<D>& plane : *this) plane.supplied -= plane.changed(particles).mass;
    }
    void enters(const Particles<D>& particles, std::size_t p) {
        for (CountingPlane<D>& plane : *this) plane.enters(particles, p);
    }
    void leaves(const Particles<D>& particles, std::size_t p) {
        for (CountingPlane<D>& plane : *this) plane.leaves(particles, p);
    }
    /// Another rank keeps what has been counted.
    void forget() {
        for (CountingPlane<D>& plane : *this) plane.passed = {}, plane.supplied = 0.0;
    }
    void serialise(Archive& archive) {
        for (std::size_t k = 0; k < this->size(); ++k)
            archive.nested(std::to_string(k) + "_", (*this)[k]);
    }
};

}  // namespace doseki
