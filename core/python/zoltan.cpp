// Recursive coordinate bisection of points by Zoltan, for python/doseki/parallel/zoltan.py. A
// module of its own: it is bound to the MPI that Zoltan was built on, which the core is not.

#include <stdexcept>
#include <string>
#include <vector>

#include <mpi.h>
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>
#include <zoltan.h>

namespace nb = nanobind;

namespace {

template <class T>
using Input = nb::ndarray<const T, nb::c_contig, nb::device::cpu>;

template <class T>
nb::ndarray<nb::numpy, T> array(const std::vector<T>& values, std::vector<std::size_t> shape) {
    T* const copy = new T[values.size() + 1];
    std::copy(values.begin(), values.end(), copy);
    nb::capsule owner(copy, [](void* p) noexcept { delete[] static_cast<T*>(p); });
    return {copy, shape.size(), shape.data(), owner};
}

void check(int code, const char* what) {
    if (code != ZOLTAN_OK && code != ZOLTAN_WARN)
        throw std::runtime_error(std::string("Zoltan: ") + what);
}

/// Cuts space so that each rank of a communicator has the same weight of points.
class Bisection {
public:
    Bisection(int fortran_comm, int dim) : dim_(dim) {
        float version = 0;
        check(Zoltan_Initialize(0, nullptr, &version), "cannot be initialised");
        zoltan_ = Zoltan_Create(MPI_Comm_f2c(fortran_comm));
        for (const auto& [name, value] : {std::pair{"DEBUG_LEVEL", "0"},
                                          {"LB_METHOD", "RCB"},
                                          {"KEEP_CUTS", "1"},
                                          {"NUM_GID_ENTRIES", "1"},
                                          {"NUM_LID_ENTRIES", "1"},
                                          {"OBJ_WEIGHT_DIM", "1"},
                                          {"RETURN_LISTS", "NONE"},
                                          {"RCB_RECTILINEAR_BLOCKS", "1"}})
            check(Zoltan_Set_Param(zoltan_, name, value), name);
        Zoltan_Set_Num_Obj_Fn(zoltan_, count, this);
        Zoltan_Set_Obj_List_Fn(zoltan_, list, this);
        Zoltan_Set_Num_Geom_Fn(zoltan_, dimension, this);
        Zoltan_Set_Geom_Multi_Fn(zoltan_, coordinates, this);
    }
    Bisection(const Bisection&) = delete;
    Bisection& operator=(const Bisection&) = delete;
    ~Bisection() {
        int finalised = 0;
        MPI_Finalized(&finalised);
        if (!finalised) Zoltan_Destroy(&zoltan_);
    }

    void cut(Input<double> points, Input<double> weights) {
        points_ = points.data(), weights_ = weights.data(),
        size_ = static_cast<int>(weights.size());
        int changes = 0, global = 0, local = 0, in = 0, out = 0;
        int *in_ranks = nullptr, *in_parts = nullptr, *out_ranks = nullptr, *out_parts = nullptr;
        ZOLTAN_ID_PTR in_global = nullptr, in_local = nullptr, out_global = nullptr,
                      out_local = nullptr;
        check(Zoltan_LB_Partition(zoltan_, &changes, &global, &local, &in, &in_global, &in_local,
                                  &in_ranks, &in_parts, &out, &out_global, &out_local, &out_ranks,
                                  &out_parts),
              "cannot cut");
        points_ = weights_ = nullptr, size_ = 0;
    }

    nb::ndarray<nb::numpy, int> owners(Input<double> points) const {
        std::vector<int> ranks(points.shape(0));
        for (std::size_t p = 0; p < ranks.size(); ++p) {
            int part = 0;
            auto* const x = const_cast<double*>(points.data() + p * static_cast<std::size_t>(dim_));
            check(Zoltan_LB_Point_PP_Assign(zoltan_, x, &ranks[p], &part), "cannot assign a point");
        }
        return array(ranks, {ranks.size()});
    }

    /// (2, dim): corners of this rank's part.
    nb::ndarray<nb::numpy, double> region(int rank) const {
        int dim = 0;
        double low[3], high[3];
        check(Zoltan_RCB_Box(zoltan_, rank, &dim, &low[0], &low[1], &low[2], &high[0], &high[1],
                             &high[2]),
              "has no box");
        std::vector<double> corners(low, low + dim_);
        corners.insert(corners.end(), high, high + dim_);
        return array(corners, {2, static_cast<std::size_t>(dim_)});
    }

    nb::ndarray<nb::numpy, int> ranks_touching(std::vector<double> low, std::vector<double> high,
                                               int ranks) const {
        low.resize(3), high.resize(3);
        std::vector<int> found(static_cast<std::size_t>(ranks)), parts(found.size());
        int n = 0, m = 0;
        check(Zoltan_LB_Box_PP_Assign(zoltan_, low[0], low[1], low[2], high[0], high[1], high[2],
                                      found.data(), &n, parts.data(), &m),
              "cannot assign a box");
        found.resize(static_cast<std::size_t>(n));
        return array(found, {found.size()});
    }

private:
    static const Bisection& of(void* data) { return *static_cast<const Bisection*>(data); }

    static int count(void* data, int* error) {
        *error = ZOLTAN_OK;
        return of(data).size_;
    }
    static void list(void* data, int, int, ZOLTAN_ID_PTR global, ZOLTAN_ID_PTR local, int,
                     float* weights, int* error) {
        const Bisection& self = of(data);
        for (int p = 0; p < self.size_; ++p) {
            global[p] = local[p] = static_cast<ZOLTAN_ID_TYPE>(p);
            weights[p] = static_cast<float>(self.weights_[p]);
        }
        *error = ZOLTAN_OK;
    }
    static int dimension(void* data, int* error) {
        *error = ZOLTAN_OK;
        return of(data).dim_;
    }
    static void coordinates(void* data, int, int, int n, ZOLTAN_ID_PTR, ZOLTAN_ID_PTR local,
                            int dim, double* out, int* error) {
        const Bisection& self = of(data);
        for (int k = 0; k < n; ++k)
            for (int a = 0; a < dim; ++a)
                out[k * dim + a] = self.points_[local[k] * static_cast<ZOLTAN_ID_TYPE>(dim) +
                                                static_cast<ZOLTAN_ID_TYPE>(a)];
        *error = ZOLTAN_OK;
    }

    int dim_, size_ = 0;
    const double *points_ = nullptr, *weights_ = nullptr;
    Zoltan_Struct* zoltan_ = nullptr;
};

}  // namespace

NB_MODULE(_zoltan, m) {
    // Of the headers: a call might reach another MPI that the process has loaded.
    m.attr("mpi_version") = "Open MPI v" + std::to_string(OMPI_MAJOR_VERSION) + "." +
                            std::to_string(OMPI_MINOR_VERSION) + "." +
                            std::to_string(OMPI_RELEASE_VERSION);
    nb::class_<Bisection>(m, "Bisection")
        .def(nb::init<int, int>(), nb::arg("fortran_comm"), nb::arg("dim"))
        .def("cut", &Bisection::cut, nb::arg("points"), nb::arg("weights"))
        .def("owners", &Bisection::owners, nb::arg("points"))
        .def("region", &Bisection::region, nb::arg("rank"))
        .def("ranks_touching", &Bisection::ranks_touching, nb::arg("low"), nb::arg("high"),
             nb::arg("ranks"));
}
