// The particles that an inflow drives, where all particles are.

#include "base/bulk.hpp"
#include "boundaries/open_boundaries.hpp"

namespace doseki {
namespace {

template <int D>
struct Drive {
    Particles<D>& particles;
    std::int32_t body;
    Vec<double, D> velocity;

    DOSEKI_DEVICE_FN void operator()(std::size_t p) const {
        const Tag& tag = particles.tag[p];
        if (tag.motion == Motion::driven && tag.body == body) particles.velocity[p] = velocity;
    }
};

}  // namespace

template <int D>
void drive(Particles<D>& particles, std::int32_t body, const Vec<double, D>& velocity) {
    bulk::for_each(particles.size(), Drive<D>{particles, body, velocity});
}

template void drive(Particles<2>&, std::int32_t, const Vec<double, 2>&);
template void drive(Particles<3>&, std::int32_t, const Vec<double, 3>&);

}  // namespace doseki
