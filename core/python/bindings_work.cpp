// How much work a pair of particles is, for the bench.

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <stdexcept>
#include <string>

#include "physics/kernel/wendland_c2.hpp"
#include "physics/kernel/wendland_c6.hpp"
#include "python/counted.hpp"
#include "resolved/interactions.hpp"
#include "ueta2022/interactions.hpp"

namespace nb = nanobind;
using namespace doseki;

namespace {

nb::dict named(const PairWork& work) {
    nb::dict row;
    row["sum"] = work.sum, row["sums"] = work.done.sums, row["products"] = work.done.products;
    row["quotients"] = work.done.quotients, row["roots"] = work.done.roots;
    row["comparisons"] = work.done.comparisons, row["bytes"] = work.bytes;
    return row;
}

template <class real, int D>
nb::list work_of_ueta2022() {
    nb::list rows;
    rows.append(named(work_of_pair<MotionPoint, MotionPoint>(
        "pass_1", VelocityGradientTerm<GradientOf::own_h, real, D>{})));
    rows.append(named(work_of_pair<MomentumPoint, MotionPoint, StressPoint>(
        "pass_2", MomentumTerm<GradientOf::own_h, real, D>{})));
    return rows;
}

template <class Kernel, class real, int D>
nb::list work_of_resolved() {
    nb::list rows;
    rows.append(named(work_of_pair<FluidPoint, MotionPoint, FluidFields>(
        "continuity", ContinuityTerm<Kernel, real, D>{})));
    rows.append(named(work_of_pair<FluidPoint, MotionPoint, FluidFields>(
        "pass_2", ForceTerm<Kernel, real, D>{})));
    return rows;
}

template <class real, int D>
nb::list work_of(const std::string& scheme, bool wide_kernel) {
    if (scheme == "ueta2022") return work_of_ueta2022<real, D>();
    if (scheme != "resolved") throw std::invalid_argument("pair_work: unknown scheme " + scheme);
    return wide_kernel ? work_of_resolved<WendlandC6<D>, real, D>()
                       : work_of_resolved<WendlandC2<D>, real, D>();
}

}  // namespace

void bind_work(nb::module_& m) {
    m.def(
        "pair_work",
        [](const std::string& scheme, int dim, const std::string& precision, bool wide_kernel) {
            if (precision == "double")
                return dim == 2 ? work_of<double, 2>(scheme, wide_kernel)
                                : work_of<double, 3>(scheme, wide_kernel);
            return dim == 2 ? work_of<float, 2>(scheme, wide_kernel)
                            : work_of<float, 3>(scheme, wide_kernel);
        },
        nb::arg("scheme"), nb::arg("dim"), nb::arg("precision"), nb::arg("wide_kernel"));
}
