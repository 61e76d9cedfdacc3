// Kernel integrals over the ground below fluid particles: sums over three layers of wall particles
// against boundary integrals. Prints a row of errors for each ground, then costs. See
// wall_integrals.py.

#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <random>

#include "boundaries/height_field.hpp"
#include "boundaries/tile_grid.hpp"

using namespace doseki;
using Vector = Vec<double, 3>;

namespace {

constexpr double dp = 1.0, support = 2.6 * dp, pi = 3.14159265358979323846;
constexpr int layers = 3;

/// Wendland C2 in 3-D with its support, and its integrals in closed form; u = r / support.
struct Kernel {
    static constexpr double scale = 21.0 / (2.0 * pi);
    static double value(double u) {  // times support^3
        const double v = 1.0 - u, v2 = v * v;
        return scale * v2 * v2 * (1.0 + 4.0 * u);
    }
    static double slope_over_u(double u) {  // dW/du / u, times support^3
        const double v = 1.0 - u;
        return -20.0 * scale * v * v * v;
    }
    /// Over a plane at this distance, times support.
    static double over_plane(double u) {
        const double u2 = u * u, u4 = u2 * u2;
        return 21.0 * (1.0 / 14.0 - (u2 / 2.0 - 2.5 * u4 + 4.0 * u4 * u - 2.5 * u4 * u2 +
                                     4.0 / 7.0 * u4 * u2 * u));
    }
    /// Over the half space behind it.
    static double behind_plane(double u) {
        const double u2 = u * u, u3 = u2 * u, u5 = u3 * u2;
        return 21.0 * (1.0 / 42.0 - (u / 14.0 - u3 / 6.0 + u5 / 2.0 - u5 * u / 1.5 +
                                     5.0 / 14.0 * u5 * u2 - u5 * u3 / 14.0));
    }
    /// From r to the end of the support: of W s^2 ds.
    static double outside(double u) {
        const double u2 = u * u, u3 = u2 * u, u5 = u3 * u2;
        return scale * (1.0 / 42.0 - (u3 / 3.0 - 2.0 * u5 + u5 * u / 0.3 - 15.0 / 7.0 * u5 * u2 +
                                      0.5 * u5 * u3));
    }
};

/// Integrals over the ground: W, grad W, and (b.y) grad W for b upwards: what the ground adds to
/// gamma, to its gradient [1/dp] and to the gradient of a pressure that is linear with depth.
struct Integrals {
    double share = 0.0;
    Vector gradient{}, linear{};

    void add(const Vector& y, double volume) {  // of a piece of ground at y from the particle
        const double u = std::sqrt(dot(y, y)) / support;
        if (u >= 1.0) return;
        const double inverse = volume / (support * support * support);
        share += inverse * Kernel::value(u);
        const Vector slope = (inverse * Kernel::slope_over_u(u) / (support * support)) * y;
        gradient = gradient + slope;
        linear = linear + y[2] * slope;
    }
};

struct Case {
    const char* name;
    double slope, curvature, wavelength;  // largest curvature [1/dp]; wavelength [dp]
};

constexpr double cell = 0.25 * dp, extent = 48.0 * dp;

HeightField<3> ground_of(const Case& ground) {
    HeightField<3> field;
    field.cell = cell;
    field.nodes = {static_cast<std::int64_t>(extent / cell),
                   static_cast<std::int64_t>(extent / cell)};
    const double k = ground.curvature > 0.0 ? 2.0 * pi / ground.wavelength : 0.0;
    const double height = ground.curvature > 0.0 ? ground.curvature / (k * k) : 0.0;
    for (std::int64_t j = 0; j < field.nodes[1]; ++j)
        for (std::int64_t i = 0; i < field.nodes[0]; ++i) {
            const double x = static_cast<double>(i) * cell, y = static_cast<double>(j) * cell;
            field.heights.push_back(ground.slope * (0.8 * x + 0.6 * y) +
                                    height * std::sin(k * (0.96 * x + 0.28 * y)));
        }
    field.measure_lean();
    return field;
}

/// By columns, each of them integrated by Gauss's rule from the support's end to the surface.
Integrals exact(const HeightField<3>& field, const Vector& at) {
    static constexpr double node[4] = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                       0.9602898564975363};
    static constexpr double weight[4] = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                         0.1012285362903763};
    constexpr int parts = 120;
    constexpr double step = 2.0 * support / parts;
    Integrals sum;
    for (int j = 0; j < parts; ++j)
        for (int i = 0; i < parts; ++i) {
            const double x = (i + 0.5) * step - support, y = (j + 0.5) * step - support;
            const double rest = support * support - x * x - y * y;
            if (rest <= 0.0) continue;
            const double low = -std::sqrt(rest);
            const double top = std::min(-low, field.height({at[0] + x, at[1] + y}) - at[2]);
            if (top <= low) continue;
            const double half = 0.5 * (top - low), middle = 0.5 * (top + low);
            for (int k = 0; k < 4; ++k)
                for (const double side : {-1.0, 1.0})
                    sum.add({x, y, middle + side * half * node[k]}, half * weight[k] * step * step);
        }
    return sum;
}

/// Particles and their volumes: those of a list, which reaches further by a skin of a tenth.
struct Piece {
    Vector position;
    double volume;
};
using Pieces = Array<Piece>;

Pieces listed(const Pieces& all, const Vector& at) {
    Pieces found;
    for (const Piece& piece : all) {
        const Vector y = piece.position - at;
        if (dot(y, y) < 1.21 * support * support && dot(y, y) > 1e-12) found.push_back(piece);
    }
    return found;
}

Integrals sum_over(const Pieces& list, const Vector& at) {
    Integrals sum;
    for (const Piece& piece : list) sum.add(piece.position - at, piece.volume);
    return sum;
}

Pieces walls_below(const HeightField<3>& field) {
    const TileGrid<3> grid(field, dp);
    Pieces walls;
    for (std::int64_t tile = 0; tile < grid.count(); ++tile)
        for (const auto& slot : WallTile<3>(field, grid, tile, layers).slots)
            walls.push_back({slot.position, slot.area * dp});
    return walls;
}

/// Fluid in layers that follow the ground, as a release has it, moved by `disorder` [dp] at most.
Pieces fluid_above(const HeightField<3>& field, double disorder) {
    const TileGrid<3> grid(field, dp);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> shift(-disorder * dp, disorder * dp);
    Pieces fluid;
    for (std::int64_t tile = 0; tile < grid.count(); ++tile)
        for (int layer = 0; layer < 5; ++layer) {
            const double height = (layer + 0.5) * dp;
            const TileLayer<3> made(field, grid.corner(tile), grid.side(), dp, -height);
            for (const auto& foot : made.feet()) {
                const auto surface = field.at(foot.place);
                const Vector x{foot.place[0], foot.place[1], surface.height};
                const Vector moved{shift(random), shift(random), 0.5 * shift(random)};
                fluid.push_back({x + height * surface.normal + moved, foot.area * dp});
            }
        }
    return fluid;
}

/// The plane through the foot of the perpendicular, in closed form.
Integrals local_plane(const HeightField<3>& field, const Vector& at) {
    const auto nearest = field.nearest(at);
    const double u = std::max(nearest.distance, 0.0) / support;
    Integrals sum;
    if (u >= 1.0) return sum;
    const double over = Kernel::over_plane(u) / support;
    sum.share = Kernel::behind_plane(u);
    sum.gradient = over * nearest.normal;
    // Of y (x) grad W: -share along the plane, and across it what is on the plane as well.
    sum.linear = (-nearest.distance * over * nearest.normal[2]) * nearest.normal;
    sum.linear[2] -= sum.share;
    return sum;
}

struct Triangle {
    std::array<Vector, 3> corner;
    Vector area;  // upwards
};

/// The surface in triangles of a side in plan, those that may be within the support of a place.
Array<Triangle> triangles_near(const HeightField<3>& field, const Vector& at, double side) {
    Array<Triangle> found;
    const auto corner = [&](double i, double j) {
        const Horizontal<3> foot{i * side, j * side};
        return Vector{foot[0], foot[1], field.height(foot)};
    };
    const auto add = [&](const Vector& p, const Vector& q, const Vector& r) {
        const Vector e = q - p, f = r - p, middle = (1.0 / 3.0) * (p + q + r) - at;
        if (dot(middle, middle) > (support + side) * (support + side)) return;
        found.push_back({{p, q, r},
                         {0.5 * (e[1] * f[2] - e[2] * f[1]), 0.5 * (e[2] * f[0] - e[0] * f[2]),
                          0.5 * (e[0] * f[1] - e[1] * f[0])}});
    };
    const double reach = support + side;
    for (double j = std::floor((at[1] - reach) / side); j <= (at[1] + reach) / side; ++j)
        for (double i = std::floor((at[0] - reach) / side); i <= (at[0] + reach) / side; ++i) {
            const Vector p = corner(i, j), q = corner(i + 1, j), r = corner(i, j + 1),
                         s = corner(i + 1, j + 1);
            add(p, q, r), add(s, r, q);
        }
    return found;
}

/// Gauss's theorem makes surface integrals of all; three points for each triangle.
Integrals over_triangles(const Array<Triangle>& triangles, const Vector& at) {
    Integrals sum;
    for (const Triangle& triangle : triangles)
        for (std::size_t k = 0; k < 3; ++k) {
            const Vector y = (1.0 / 6.0) * (triangle.corner[0] + triangle.corner[1] +
                                            triangle.corner[2] + 3.0 * triangle.corner[k]) -
                             at;
            const double length = std::sqrt(dot(y, y)), u = length / support;
            if (u >= 1.0) continue;
            const Vector piece = (1.0 / 3.0) * triangle.area;
            const double w = Kernel::value(u) / (support * support * support);
            sum.share -= dot(y, piece) * Kernel::outside(u) / (length * length * length);
            sum.gradient = sum.gradient + w * piece;
            sum.linear = sum.linear + (w * y[2]) * piece;
        }
    sum.linear[2] -= sum.share;
    return sum;
}

/// Root mean squares.
struct Error {
    double share = 0.0, gradient = 0.0, linear = 0.0;
    int count = 0;
    void add(const Integrals& found, const Integrals& exact) {
        const Vector g = found.gradient - exact.gradient, l = found.linear - exact.linear;
        share += (found.share - exact.share) * (found.share - exact.share);
        gradient += dp * dp * dot(g, g), linear += dot(l, l), ++count;
    }
    void print() const {
        for (const double sum : {share, gradient, linear})
            std::printf(" %.5f", std::sqrt(sum / count));
    }
};

Integrals operator+(const Integrals& a, const Integrals& b) {
    return {a.share + b.share, a.gradient + b.gradient, a.linear + b.linear};
}

void print_errors(const Case& ground) {
    const HeightField<3> field = ground_of(ground);
    const Pieces walls = walls_below(field);
    for (const double disorder : {0.0, 0.1}) {
        const Pieces fluid = fluid_above(field, disorder);
        Error alone[4], whole[4];
        std::size_t seen = 0;
        for (std::size_t k = 0; k < fluid.size() && seen < 200; ++k) {
            const Vector& at = fluid[(k * 7919) % fluid.size()].position;
            const double height = field.nearest(at).distance;
            const auto middle = [](double x) { return x > 14.0 * dp && x < extent - 14.0 * dp; };
            if (height > 2.0 * dp || !middle(at[0]) || !middle(at[1])) continue;
            ++seen;
            // Of all space: the kernel itself, no gradient, and minus the gradient of the pressure.
            const Integrals space{1.0, {}, {0.0, 0.0, -1.0}}, truth = exact(field, at);
            Integrals flow = sum_over(listed(fluid, at), at);
            flow.add({}, dp * dp * dp);
            const Integrals found[] = {sum_over(listed(walls, at), at), local_plane(field, at),
                                       over_triangles(triangles_near(field, at, dp), at),
                                       over_triangles(triangles_near(field, at, 0.5 * dp), at)};
            for (int m = 0; m < 4; ++m)
                alone[m].add(found[m], truth), whole[m].add(flow + found[m], space);
        }
        for (int m = 0; m < 4; ++m) {
            std::printf("error %s %.1f %d", ground.name, disorder, m);
            alone[m].print(), whole[m].print();
            std::printf("\n");
        }
    }
}

/// Processor time of a call for one of so many particles [ns], the least of some turns.
template <class F>
double nanoseconds(int count, const F& f) {
    constexpr int rounds = 200;
    double least = 1e30;
    volatile double sink = 0.0;
    for (int turn = 0; turn < 7; ++turn) {
        const std::clock_t start = std::clock();
        for (int k = 0; k < rounds * count; ++k)
            sink = sink + f(static_cast<std::size_t>(k % count));
        const double spent = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
        least = std::min(least, 1e9 * spent / (rounds * count));
    }
    return least;
}

void print_costs() {
    const HeightField<3> field = ground_of({"", 0.3, 0.05, 12.0});
    const Pieces walls = walls_below(field);
    constexpr int count = 64;
    std::mt19937 random(7);
    std::uniform_real_distribution<double> inside(16.0 * dp, 32.0 * dp), height(0.3, 2.0);
    Array<Vector> places;
    Array<Pieces> pieces;
    Array<Array<Triangle>> coarse, fine;
    double pairs = 0.0, faces = 0.0;
    for (int k = 0; k < count; ++k) {
        const Horizontal<3> foot{inside(random), inside(random)};
        const auto surface = field.at(foot);
        const Vector x{foot[0], foot[1], surface.height};
        places.push_back(x + height(random) * dp * surface.normal);
        pieces.push_back(listed(walls, places.back()));
        coarse.push_back(triangles_near(field, places.back(), dp));
        fine.push_back(triangles_near(field, places.back(), 0.5 * dp));
        pairs += static_cast<double>(pieces.back().size()) / count;
        faces += static_cast<double>(coarse.back().size()) / count;
    }
    const auto cost = [&](const char* name, const auto& f) {
        std::printf("cost %s %.1f\n", name, nanoseconds(count, f));
    };
    std::printf("listed %.1f %.1f\n", pairs, faces);
    cost("particles", [&](std::size_t k) { return sum_over(pieces[k], places[k]).linear[2]; });
    cost("surface", [&](std::size_t k) { return field.nearest(places[k]).distance; });
    cost("plane", [&](std::size_t k) { return local_plane(field, places[k]).linear[2]; });
    cost("triangles",
         [&](std::size_t k) { return over_triangles(coarse[k], places[k]).linear[2]; });
    cost("fine", [&](std::size_t k) { return over_triangles(fine[k], places[k]).linear[2]; });
}

}  // namespace

int main() {
    for (const Case& ground :
         {Case{"level", 0.0, 0.0, 0.0}, Case{"slope_30", 0.577, 0.0, 0.0},
          Case{"waves_0.02", 0.0, 0.02, 24.0}, Case{"waves_0.05", 0.0, 0.05, 16.0},
          Case{"waves_0.1", 0.0, 0.1, 12.0}, Case{"waves_0.2", 0.0, 0.2, 8.0},
          Case{"slope_30_waves_0.1", 0.577, 0.1, 12.0}})
        print_errors(ground);
    print_costs();
}
