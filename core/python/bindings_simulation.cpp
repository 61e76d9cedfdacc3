// Simulations as Python sees them: one class for every scheme, dimension and precision.

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "base/error.hpp"
#include "interface/any_simulation.hpp"
#include "python/exchange.hpp"
#include "python/values.hpp"

namespace doseki {
namespace {

class PythonSimulation {
    using Corner = std::vector<double>;
    /// Kind, id of the particle to blame and its position; -1 and nothing where it is none.
    using Failure = std::tuple<std::string, std::int64_t, std::vector<double>>;

public:
    PythonSimulation(const std::string& scheme, int dim, const std::string& precision,
                     const nb::list& materials, const nb::dict& options)
        : core_(SimulationKind::make(scheme, dim, precision, to_tables(materials),
                                     to_table(options))),
          dim_(dim) {}

    void add_particles(const nb::kwargs& columns) { core_->add_particles(to_table(columns)); }
    void set_walls(const nb::kwargs& columns) { core_->set_walls(to_table(columns)); }
    void set_edges(const nb::kwargs& columns) { core_->set_edges(to_table(columns)); }
    void set_faces(const nb::kwargs& columns) { core_->set_faces(to_table(columns)); }
    void add_shapes(const nb::list& shapes) { core_->add_shapes(to_tables(shapes)); }
    void add_rigid_bodies(const nb::dict& columns) { core_->add_rigid_bodies(to_table(columns)); }
    void bind_points(const nb::object& body) {
        NamedValues columns;
        columns["body"] = to_value(body);
        core_->bind_points(columns);
    }
    void add_elastic_body(const nb::dict& body) { core_->add_elastic_body(to_table(body)); }
    void add_inflow(const nb::dict& inflow) { core_->add_inflow(to_table(inflow)); }
    void add_outflow(const Corner& low, const Corner& high) { core_->add_outflow(low, high); }
    void add_plane(const Corner& point, const Corner& normal) { core_->add_plane(point, normal); }
    void move_body(const nb::dict& motion) { core_->move_body(to_table(motion)); }
    void set_terrain(const nb::dict& field, const nb::dict& wall) {
        core_->set_terrain(to_table(field), to_table(wall));
    }
    void share_terrain(nb::object source) { core_->share_terrain(asking(std::move(source))); }
    void make_room_in_terrain(nb::object remainder) {
        core_->make_room_in_terrain(asking(std::move(remainder)));
    }
    void add_load_meter(const nb::dict& meter) { core_->add_load_meter(to_table(meter)); }
    void set_stresses(const nb::object& deviatoric_stress) {
        NamedValues columns;
        columns["deviatoric_stress"] = to_value(deviatoric_stress);
        core_->set_stresses(columns);
    }
    void begin_at(double time) { core_->begin_at(time); }
    void join(nb::object transport) {
        core_->join(std::make_unique<PythonExchange>(std::move(transport)));
    }

    void start() {
        guarded([&] { core_->start(); });
    }
    void advance(double limit, double pause, std::int64_t max_steps) {
        guarded([&] { core_->advance(limit, pause, max_steps); });
    }
    const Failure& failure() const { return failure_; }

    nb::dict state() const { return to_python(core_->state()); }
    nb::dict rates() const { return to_python(core_->rates()); }
    nb::dict totals() const { return to_python(core_->totals()); }
    nb::dict grains() const { return to_python(core_->grains()); }
    nb::dict fragments() const { return to_python(core_->fragments()); }
    nb::dict body_energy() { return to_python(core_->body_energy()); }
    void cut_bodies(const nb::object& label) {
        NamedValues columns;
        columns["label"] = to_value(label);
        core_->cut_bodies(columns);
    }
    nb::dict loads() const { return to_python(core_->loads()); }
    void forget_load_peak(std::size_t meter) { core_->forget_load_peak(meter); }
    nb::dict sample(const Corner& low, const Corner& high) const {
        return to_python(core_->sample(low, high));
    }
    nb::dict force_terms(std::int64_t particle) { return to_python(core_->force_terms(particle)); }
    nb::dict neighbour_counts() const { return to_python(core_->neighbour_counts()); }
    nb::dict shares() const { return to_python(core_->shares()); }
    nb::dict phase_seconds() { return to_python(core_->phase_seconds()); }

    nb::dict checkpoint() { return to_python(core_->checkpoint()); }
    bool restore(const nb::dict& arrays) { return core_->restore(to_table(arrays)); }
    void restore_shared(const nb::dict& arrays) { core_->restore_shared(to_table(arrays)); }

    AnySimulation& core() { return *core_; }
    const AnySimulation& core() const { return *core_; }

private:
    /// Python's exceptions carry only a text; what else a failure says is kept here.
    template <class F>
    void guarded(F&& work) {
        failure_ = no_failure();
        try {
            work();
        } catch (const PhysicsFailure& failure) {
            const auto& x = failure.site.position;
            failure_ = {name_of(failure.kind),
                        failure.site.id,
                        {x.begin(), x.begin() + (failure.site.id < 0 ? 0 : dim_)}};
            throw;
        }
#if defined(DOSEKI_CUDA)
        catch (const ResourceFailure&) {
            throw;
        } catch (const std::runtime_error& error) {  // Thrust's, of the driver
            throw ResourceFailure(std::string("the graphics card failed: ") + error.what() +
                                  "; resume goes on from the last checkpoint, also with "
                                  "--device cpu");
        }
#endif
    }

    static Failure no_failure() { return {"", -1, {}}; }

    /// A function of numbers to numbers that Python answers.
    static AnySimulation::NumberReader asking(nb::object answer) {
        return [answer = std::move(answer)](const Array<double>& question) {
            const nb::gil_scoped_acquire locked;
            using Numbers = nb::ndarray<const double, nb::c_contig, nb::device::cpu>;
            const std::vector<double> request(question.begin(), question.end());
            const auto found = nb::cast<Numbers>(answer(request));
            return Array<double>(found.data(), found.data() + found.size());
        };
    }

    std::unique_ptr<AnySimulation> core_;
    int dim_;
    Failure failure_ = no_failure();
};

using P = PythonSimulation;
using Class = nb::class_<P>;

void bind_setup(Class& c) {
    c.def(nb::init<const std::string&, int, const std::string&, const nb::list&, const nb::dict&>(),
          nb::arg("scheme"), nb::arg("dim"), nb::arg("precision"), nb::arg("materials"),
          nb::arg("options"),
          nb::sig("def __init__(self, scheme: str, dim: int, precision: str, materials: "
                  "collections.abc.Sequence[doseki.solver.protocol.Table], options: "
                  "doseki.solver.protocol.Table) -> None"))
        .def("add_particles", &P::add_particles,
             nb::sig("def add_particles(self, *, position: numpy.ndarray, velocity: numpy.ndarray, "
                     "mass: numpy.ndarray, density: numpy.ndarray, smoothing_length: "
                     "numpy.ndarray, material: numpy.ndarray, body: numpy.ndarray, motion: "
                     "numpy.ndarray, id: numpy.ndarray) -> None"))
        .def("set_edges", &P::set_edges,
             nb::sig(
                 "def set_edges(self, *, normals: numpy.ndarray, depths: numpy.ndarray) -> None"))
        .def("set_faces", &P::set_faces,
             nb::sig("def set_faces(self, *, face: numpy.ndarray, area: numpy.ndarray) -> None"))
        .def("set_walls", &P::set_walls,
             nb::sig("def set_walls(self, *, normal: numpy.ndarray, depth: numpy.ndarray, "
                     "curvature: numpy.ndarray) -> None"))
        .def("add_shapes", &P::add_shapes, nb::arg("shapes"),
             nb::sig("def add_shapes(self, shapes: "
                     "collections.abc.Sequence[doseki.solver.protocol.Table]) -> None"))
        .def("add_rigid_bodies", &P::add_rigid_bodies, nb::arg("bodies"),
             nb::sig("def add_rigid_bodies(self, bodies: doseki.solver.protocol.Arrays) -> None"))
        .def("bind_points", &P::bind_points, nb::arg("body"),
             nb::sig("def bind_points(self, body: numpy.ndarray) -> None"))
        .def("add_elastic_body", &P::add_elastic_body, nb::arg("body"),
             nb::sig("def add_elastic_body(self, body: doseki.solver.protocol.Table) -> None"))
        .def("add_inflow", &P::add_inflow, nb::arg("inflow"),
             nb::sig("def add_inflow(self, inflow: doseki.solver.protocol.Table) -> None"))
        .def("add_outflow", &P::add_outflow, nb::arg("low"), nb::arg("high"))
        .def("add_plane", &P::add_plane, nb::arg("point"), nb::arg("normal"))
        .def("move_body", &P::move_body, nb::arg("motion"),
             nb::sig("def move_body(self, motion: doseki.solver.protocol.Table) -> None"))
        .def("set_terrain", &P::set_terrain, nb::arg("field"), nb::arg("wall"),
             nb::sig("def set_terrain(self, field: doseki.solver.protocol.Table, wall: "
                     "doseki.solver.protocol.Table) -> None"))
        .def("share_terrain", &P::share_terrain, nb::arg("source"),
             nb::sig("def share_terrain(self, source: collections.abc.Callable[[list[float]], "
                     "numpy.ndarray]) -> None"))
        .def("make_room_in_terrain", &P::make_room_in_terrain, nb::arg("remainder"),
             nb::sig("def make_room_in_terrain(self, remainder: "
                     "collections.abc.Callable[[list[float]], numpy.ndarray]) -> None"))
        .def("add_load_meter", &P::add_load_meter, nb::arg("meter"),
             nb::sig("def add_load_meter(self, meter: doseki.solver.protocol.Table) -> None"))
        .def("set_stresses", &P::set_stresses, nb::arg("deviatoric_stress"),
             nb::sig("def set_stresses(self, deviatoric_stress: numpy.ndarray) -> None"))
        .def("begin_at", &P::begin_at, nb::arg("time"))
        .def("join", &P::join, nb::arg("transport"),
             nb::sig("def join(self, transport: object) -> None"));
}

void bind_results(Class& c) {
    c.def("state", &P::state, nb::sig("def state(self) -> doseki.solver.protocol.Columns"))
        .def("rates", &P::rates, nb::sig("def rates(self) -> doseki.solver.protocol.Rates"))
        .def("totals", &P::totals, nb::sig("def totals(self) -> doseki.solver.protocol.Totals"))
        .def("grains", &P::grains, nb::sig("def grains(self) -> doseki.solver.protocol.Grains"))
        .def("fragments", &P::fragments,
             nb::sig("def fragments(self) -> doseki.solver.protocol.Fragments"))
        .def("body_energy", &P::body_energy, nb::sig("def body_energy(self) -> dict[str, float]"),
             "Energy of the bodies, J (2-D: J/m): kinetic, strain, springs inside, contacts.")
        .def("cut_bodies", &P::cut_bodies, nb::arg("label"),
             nb::sig("def cut_bodies(self, label: numpy.ndarray) -> None"))
        .def("loads", &P::loads, nb::sig("def loads(self) -> doseki.solver.protocol.Loads"))
        .def("forget_load_peak", &P::forget_load_peak, nb::arg("meter"))
        .def("sample", &P::sample, nb::arg("low"), nb::arg("high"),
             nb::sig("def sample(self, low: collections.abc.Sequence[float], high: "
                     "collections.abc.Sequence[float]) -> "
                     "doseki.solver.protocol.Columns"))
        .def("force_terms", &P::force_terms, nb::arg("particle"),
             nb::sig("def force_terms(self, particle: int) -> doseki.solver.protocol.ForceTerms"))
        .def("neighbour_counts", &P::neighbour_counts,
             nb::sig("def neighbour_counts(self) -> doseki.solver.protocol.Columns"))
        .def("shares", &P::shares, nb::sig("def shares(self) -> dict[str, float]"))
        .def("phase_seconds", &P::phase_seconds,
             nb::sig("def phase_seconds(self) -> dict[str, float]"))
        .def("checkpoint", &P::checkpoint,
             nb::sig("def checkpoint(self) -> doseki.solver.protocol.Columns"))
        .def("restore", &P::restore, nb::arg("arrays"),
             nb::sig("def restore(self, arrays: doseki.solver.protocol.Arrays) -> bool"))
        .def("restore_shared", &P::restore_shared, nb::arg("arrays"),
             nb::sig("def restore_shared(self, arrays: doseki.solver.protocol.Arrays) -> None"));
}

void bind_progress(Class& c) {
    c.def_prop_ro("time", [](const P& p) { return p.core().progress().time; })
        .def_prop_ro("timestep", [](const P& p) { return p.core().progress().timestep; })
        .def_prop_ro("steps", [](const P& p) { return p.core().progress().steps; })
        .def_prop_ro("rebuilds", [](const P& p) { return p.core().progress().rebuilds; })
        .def_prop_ro("updates", [](const P& p) { return p.core().progress().updates; })
        .def_prop_ro("skin", [](const P& p) { return p.core().progress().skin; })
        .def("__len__", [](const P& p) { return p.core().progress().particles; })
        .def_prop_ro("bytes_per_particle", [](const P& p) { return p.core().bytes_per_particle(); })
        .def_prop_ro("entries_per_particle",
                     [](const P& p) { return p.core().entries_per_particle(); })
        .def_prop_ro("has_bodies", [](const P& p) { return p.core().has_bodies(); })
        .def_prop_ro("particle_arrays", [](const P& p) { return p.core().particle_arrays(); })
        .def_prop_ro("failure", &P::failure,
                     nb::sig("def failure(self) -> doseki.solver.protocol.CoreFailure"));
}

void bind_work(Class& c) {
    const auto unlocked = nb::call_guard<nb::gil_scoped_release>();
    c.def("start", &P::start, unlocked)
        .def("advance", &P::advance, nb::arg("limit"), nb::arg("pause"), nb::arg("max_steps"),
             unlocked)
        .def(
            "time_phases", [](P& p, bool on) { p.core().time_phases(on); }, nb::arg("on"))
        .def(
            "interacting_pairs", [](const P& p) { return p.core().interacting_pairs(); }, unlocked)
        .def(
            "bare_pair_rate",
            [](const P& p, double seconds) { return p.core().bare_pair_rate(seconds); },
            nb::arg("seconds"), unlocked);
}

}  // namespace
}  // namespace doseki

void bind_simulation(nanobind::module_& m) {
    doseki::Class c(m, "Simulation", "What solver.protocol.CoreSimulation describes.");
    doseki::bind_setup(c), doseki::bind_results(c), doseki::bind_progress(c), doseki::bind_work(c);
}
