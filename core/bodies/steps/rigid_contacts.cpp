// What contacts see of rigid bodies and do to them, where the bodies are.

#include "base/bulk.hpp"
#include "bodies/rigid_bodies.hpp"

namespace doseki {
namespace {

template <int D>
struct ShowSolid {
    RigidBodiesSeen<D> rigid;
    std::span<ContactSolid<D>> solids;

    DOSEKI_DEVICE_FN void operator()(std::size_t n) const {
        ContactSolid<D>& solid = solids[n];
        const auto k = static_cast<std::size_t>(solid.body);
        const RigidBodyState<D>& state = rigid.states[k];
        solid.centre = state.centre, solid.velocity = state.velocity;
        solid.rotation = state.orientation.matrix(), solid.spin = rigid.spin(k);
        solid.removed = state.is_removed();
        solid.force = {}, solid.torque = {};
    }
};

/// The rigid bodies of points that are shown.
template <int D>
struct BodiesShown {
    ContactPointSpans<D> all;
    std::span<const std::int32_t> points;
    std::span<const std::uint32_t> first;  // see ShownPoints

    DOSEKI_DEVICE_FN std::size_t point(std::size_t n) const {
        return static_cast<std::size_t>(points[n]);
    }
    DOSEKI_DEVICE_FN std::size_t body_of(std::size_t point) const {
        return static_cast<std::size_t>(all.body[point]);
    }
};

/// All points of a body turn alike.
template <int D>
struct FindPose {
    RigidBodiesSeen<D> rigid;
    BodiesShown<D> shown;
    std::span<BodyPose> poses;

    DOSEKI_DEVICE_FN void operator()(std::size_t n) const {
        const std::size_t k = shown.body_of(shown.point(shown.first[n]));
        poses[k].spin = rigid.spin(k);
        if (!rigid.shape(k).is_ball()) poses[k].rotation = rigid.states[k].orientation.matrix();
    }
};

template <int D>
struct ShowPoint {
    RigidBodiesSeen<D> rigid;
    BodiesShown<D> shown;
    std::span<const BodyPose> poses;

    DOSEKI_DEVICE_FN void operator()(std::size_t n) const {
        const std::size_t c = shown.point(n), k = shown.body_of(c);
        const RigidBodyState<D>& state = rigid.states[k];
        const Vec3& w = poses[k].spin;
        const ContactPointSpans<D>& all = shown.all;
        const Vec<double, D> lever =
            rigid.shape(k).is_ball() ? Vec<double, D>{} : rotated(poses[k].rotation, all.offset[c]);
        all.position[c] = state.centre + lever;
        all.outward[c] = rigid.shape(k).is_ball() ? Vec<double, D>{}
                                                  : rotated(poses[k].rotation, all.own_outward[c]);
        all.velocity[c] = state.velocity + turning_velocity(w, lever);
        all.spin[c] = w, all.removed[c] = state.is_removed();
        all.force[c] = {}, all.torque[c] = {};
    }
};

/// The sum over the points of a body, in their order.
template <int D>
struct CollectFromPoints {
    RigidBodiesMoved<D> rigid;
    BodiesShown<D> shown;

    DOSEKI_DEVICE_FN void operator()(std::size_t n) const {
        const std::size_t k = shown.body_of(shown.point(shown.first[n]));
        const ContactPointSpans<D>& all = shown.all;
        Vec<double, D> force{};
        Vec3 torque{};
        for (std::size_t m = shown.first[n]; m < shown.first[n + 1]; ++m) {
            const std::size_t c = shown.point(m);
            const Vec3 lever = in_space(all.position[c] - rigid.states[k].centre);
            force = force + all.force[c];
            torque = torque + all.torque[c] + cross(lever, in_space(all.force[c]));
        }
        rigid.contact_force[k] = force, rigid.contact_torque[k] = torque;
    }
};

template <int D>
struct CollectFromSolid {
    RigidBodiesMoved<D> rigid;
    std::span<const ContactSolid<D>> solids;

    DOSEKI_DEVICE_FN void operator()(std::size_t n) const {
        const auto k = static_cast<std::size_t>(solids[n].body);
        rigid.contact_force[k] = rigid.contact_force[k] + solids[n].force;
        rigid.contact_torque[k] = rigid.contact_torque[k] + solids[n].torque;
    }
};

}  // namespace

template <int D>
void RigidBodies<D>::show(ContactBodies<D>& contact, const ShownPoints& points) {
    const RigidBodiesSeen<D> rigid = seen();
    const BodiesShown<D> shown{contact.points.spans(), points.points, points.first};
    bulk::for_each(contact.solids.size(), ShowSolid<D>{rigid, contact.solids});
    poses_.resize(size());
    bulk::for_each(points.rigid_bodies(), FindPose<D>{rigid, shown, poses_});
    bulk::for_each(points.rigid_points(), ShowPoint<D>{rigid, shown, poses_});
}

template <int D>
void RigidBodies<D>::collect(ContactBodies<D>& contact, const ShownPoints& points) {
    const BodiesShown<D> shown{contact.points.spans(), points.points, points.first};
    bulk::for_each(size(), ClearElement<Vec<double, D>>{contact_force_});
    bulk::for_each(size(), ClearElement<Vec3>{contact_torque_});
    bulk::for_each(points.rigid_bodies(), CollectFromPoints<D>{moved(), shown});
    bulk::for_each(contact.solids.size(), CollectFromSolid<D>{moved(), contact.solids});
}

template void RigidBodies<2>::show(ContactBodies<2>&, const ShownPoints&);
template void RigidBodies<3>::show(ContactBodies<3>&, const ShownPoints&);
template void RigidBodies<2>::collect(ContactBodies<2>&, const ShownPoints&);
template void RigidBodies<3>::collect(ContactBodies<3>&, const ShownPoints&);

}  // namespace doseki
