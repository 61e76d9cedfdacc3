#include "boundaries/counting_planes.hpp"

#include <functional>
#include <span>

#include "base/bulk.hpp"

namespace doseki {
namespace {

template <int D>
struct NoteSide {
    const Particles<D>& particles;
    const CountingPlane<D>& plane;
    std::span<std::uint8_t> beyond;

    DOSEKI_DEVICE_FN void operator()(std::size_t p) const {
        beyond[p] = plane.is_beyond(particles.position[p]);
    }
};

template <int D>
struct ChangeOfSide {
    const Particles<D>& particles;
    const CountingPlane<D>& plane;
    std::span<std::uint8_t> beyond;

    DOSEKI_DEVICE_FN MassAndVolume operator()(std::size_t p) const {
        const std::uint8_t now = plane.is_beyond(particles.position[p]);
        if (now == beyond[p]) return {};
        beyond[p] = now;
        if (!particles.is_counted(p)) return {};
        const double mass = now ? particles.mass[p] : -particles.mass[p];
        return {mass, mass / particles.density[p]};
    }
};

}  // namespace

template <int D>
void CountingPlane<D>::look(const Particles<D>& particles) {
    beyond_.resize(particles.size());
    bulk::for_each(particles.size(), NoteSide<D>{particles, *this, beyond_});
}

template <int D>
MassAndVolume CountingPlane<D>::changed(const Particles<D>& particles) {
    return bulk::reduce(particles.size(), MassAndVolume{}, std::plus<MassAndVolume>{},
                        ChangeOfSide<D>{particles, *this, beyond_});
}

template struct CountingPlane<2>;
template struct CountingPlane<3>;

}  // namespace doseki
