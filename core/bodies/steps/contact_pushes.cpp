// What contacts do to bodies, where the bodies are. Each body takes what its pairs do to it in
// their order, so that sums do not depend on the number of threads.

#include "base/bulk.hpp"
#include "bodies/contacts.hpp"

namespace doseki {
namespace {

template <int D>
struct PushPair {
    ContactRows<D> rows;
    std::span<const std::size_t> which;
    double moved, dt;

    DOSEKI_WHOLE_DEVICE_FN void operator()(std::size_t n) const {
        const std::size_t k = which[n];
        if (rows.contacts[k].gap > rows.contacts[k].approach(moved))
            rows.part(k);
        else
            rows.push(k, dt);
    }
};

template <int D>
struct PushPoint {
    ContactPointSpans<D> points;
    std::span<const std::int32_t> which;
    std::span<const std::size_t> first_push, pushes_on;  // see Contacts::Selection
    std::span<const PairPush<D>> pushes;

    DOSEKI_DEVICE_FN void operator()(std::size_t n) const {
        const auto c = static_cast<std::size_t>(which[n]);
        for (std::size_t m = first_push[n]; m < first_push[n + 1]; ++m) {
            const std::size_t side = pushes_on[m];
            const PairPush<D>& push = pushes[side / 2];
            if (!push.touches) continue;
            const bool second = side % 2 == 1;
            points.force[c] = points.force[c] + (second ? -1.0 : 1.0) * push.force;
            points.torque[c] = points.torque[c] + (second ? push.torque_b : push.torque_a);
        }
    }
};

template <int D>
struct LoadOnSolid {
    Vec<double, D> force{};
    Vec3 torque{};
};

template <int D>
struct SumOnSolid {
    std::span<const std::size_t> rows, first_row;
    std::span<const PairPush<D>> pushes;
    std::span<LoadOnSolid<D>> loads;  // of each part

    DOSEKI_DEVICE_FN void operator()(std::size_t part) const {
        LoadOnSolid<D> sum{};
        for (std::size_t n = first_row[part]; n < first_row[part + 1]; ++n) {
            const PairPush<D>& push = pushes[rows[n]];
            if (!push.touches) continue;
            sum.force = sum.force + -1.0 * push.force, sum.torque = sum.torque + push.torque_b;
        }
        loads[part] = sum;
    }
};

template <int D>
struct PushSolid {
    std::span<const std::size_t> solids, first_part;
    std::span<const LoadOnSolid<D>> loads;
    std::span<ContactSolid<D>> all;

    DOSEKI_DEVICE_FN void operator()(std::size_t n) const {
        ContactSolid<D>& solid = all[solids[n]];
        for (std::size_t part = first_part[n]; part < first_part[n + 1]; ++part)
            solid.force = solid.force + loads[part].force,
            solid.torque = solid.torque + loads[part].torque;
    }
};

/// Over the diameter.
template <int D>
struct OverlapOfRow {
    ContactRows<D> rows;
    std::span<const std::size_t> which;

    DOSEKI_DEVICE_FN double operator()(std::size_t n) const {
        const PairContact& contact = rows.contacts[which[n]];
        const bool counts = contact.law.rigid && !contact.law.dust && rows.pushes[which[n]].touches;
        return counts ? contact.overlap / contact.law.diameter : 0.0;
    }
};

template <int D>
struct FindGap {
    ContactRows<D> rows;
    double margin;

    DOSEKI_WHOLE_DEVICE_FN void operator()(std::size_t k) const {
        rows.contacts[k].gap = rows.gap(k, margin);
    }
};

template <int D>
void push_solids(const PushesOnSolids& on, std::span<const PairPush<D>> pushes,
                 std::span<ContactSolid<D>> solids) {
    Array<LoadOnSolid<D>> loads(on.parts());
    bulk::for_each_contact(on.parts(), SumOnSolid<D>{on.rows, on.first_row, pushes, loads});
    bulk::for_each(on.solids.size(), PushSolid<D>{on.solids, on.first_part, loads, solids});
}

}  // namespace

template <int D>
void Contacts<D>::apply(ContactBodies<D>& bodies, PairKind kind, double moved, double dt) {
    Selection& selection = of(kind);
    pushes_.resize(pairs_.size());
    if (apart_) keep(selection);
    const ContactRows<D> all = rows(bodies);
    const std::span<const std::size_t> which = selection.rows;
    bulk::for_each_contact(which.size(), PushPair<D>{all, which, moved, dt});
    JointContacts& joint = selection.joint;
    bulk::for_each_contact(joint.size(),
                           PushTogether<D>{all, joint.rows, joint.first, joint.order, dt});
    const Array<std::int32_t>& points = selection.points.points;
    bulk::for_each_contact(points.size(),
                           PushPoint<D>{all.bodies.points, points, selection.first_push,
                                        selection.pushes_on, pushes_});
    push_solids<D>(selection.on_solids, pushes_, bodies.solids);
    for (const std::size_t k : selection.on_surfaces)
        if (const PairPush<D>& push = pushes_[k]; push.touches)
            all.bodies.surface(pairs_[k])->push(push.overlap.at, -1.0 * push.force, push.torque_b);
    max_overlap_ = bulk::reduce(which.size(), max_overlap_, maximum, OverlapOfRow<D>{all, which});
}

template <int D>
void Contacts<D>::find_gaps(ContactBodies<D>& bodies, double margin) {
    bulk::for_each_contact(pairs_.size(), FindGap<D>{rows(bodies), margin});
}

template void Contacts<2>::apply(ContactBodies<2>&, PairKind, double, double);
template void Contacts<3>::apply(ContactBodies<3>&, PairKind, double, double);
template void Contacts<2>::find_gaps(ContactBodies<2>&, double);
template void Contacts<3>::find_gaps(ContactBodies<3>&, double);

}  // namespace doseki
