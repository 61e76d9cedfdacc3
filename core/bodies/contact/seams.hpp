#pragma once
// Where fixed bodies that stand together make one surface.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "base/array.hpp"
#include "bodies/contact_points.hpp"
#include "bodies/shapes/facet.hpp"
#include "model/domain.hpp"

namespace doseki {

/// Of each solid: the facets of its shape, none of one that makes no surface with others, and which
/// ones stand together, having one number; -1: it stands with none.
template <int D>
struct Standing {
    const Array<Facet<D>>* facets = nullptr;
    std::int32_t with = -1;
};

/// What fixed bodies make together: samples of theirs at which others go on, or the next image of
/// the body itself, are no corners or edges, and faces that lie in one plane are one.
template <int D>
class Seams {
public:
    Seams() = default;
    Seams(const ContactBodies<D>& bodies, const Array<Standing<D>>& standing,
          const Domain<D>& domain)
        : hidden_(bodies.points.size(), 0), wall_(bodies.solids.size(), -1) {
        Finder finder{bodies, standing, domain, faces_, wall_, {}, {}, {}, {}};
        finder.faces_of.resize(bodies.solids.size());
        finder.first_point.resize(bodies.solids.size());
        for (std::size_t c = bodies.points.size(); c-- > 0;)
            if (const std::int32_t of = bodies.points.solid[c]; of >= 0)
                finder.first_point[static_cast<std::size_t>(of)] = c;
        std::size_t s = bodies.solids.size();
        for (std::size_t c = 0; c < bodies.points.size(); ++c) {
            if (bodies.points.solid[c] < 0) continue;
            const auto own = static_cast<std::size_t>(bodies.points.solid[c]);
            if (standing[own].with < 0 || !standing[own].facets) continue;
            if (own != s) finder.look_around(s = own);
            hidden_[c] = finder.is_hidden(s, bodies.points.position[c]);
        }
        std::ranges::stable_sort(faces_, {}, &WallFace<D>::solid);
    }

    /// To the contacts of the same bodies, and of others that have come after them.
    void show(ContactBodies<D>& bodies) const {
        std::ranges::copy(hidden_, bodies.points.hidden.begin());
        bodies.faces = faces_;
        for (std::size_t s = 0; s < wall_.size(); ++s) bodies.solids[s].wall = wall_[s];
        for (std::size_t f = 0; f < faces_.size(); ++f) {
            ContactSolid<D>& solid = bodies.solids[static_cast<std::size_t>(faces_[f].solid)];
            if (solid.end_face == 0) solid.first_face = f;
            solid.end_face = f + 1;
        }
    }

private:
    // Of the radius of a body: a gap that is none, the reach beyond which a surface may bend, and
    // a step that is none.
    static constexpr double near = 1e-4, far = 1e-3, step = 1e-7;

    struct Finder {
        const ContactBodies<D>& bodies;
        const Array<Standing<D>>& standing;
        const Domain<D>& domain;
        Array<WallFace<D>>& faces;
        Array<std::int32_t>& wall;
        Array<std::size_t> around;       // solids that stand with the one that is looked at, and it
        Array<std::size_t> here;         // those of them near the place that is looked at
        Array<std::size_t> first_point;  // of each solid
        Array<Array<std::size_t>> faces_of;  // each solid

        void look_around(std::size_t s) {
            around.clear();
            const ContactSolid<D>& own = bodies.solids[s];
            for (std::size_t t = 0; t < bodies.solids.size(); ++t) {
                if (standing[t].with != standing[s].with) continue;
                const ContactSolid<D>& other = bodies.solids[t];
                const double reach = 2.0 * (own.surface->radius() + other.surface->radius());
                if (norm(nearest_image(domain, other.centre - own.centre)) < reach)
                    around.push_back(t);
            }
        }

        /// Whether half a space around x, which lies on solid s, belongs to these bodies.
        bool is_hidden(std::size_t s, const Vec<double, D>& x) {
            if (!meets_another(s, x)) return false;
            here.clear();
            for (const std::size_t t : around)
                if (t == s || holds(t, x, 1.1 * far * radius(s))) here.push_back(t);
            bool hidden = false;
            for (const Vec<double, D>& n : normals_at(s, x))
                hidden = goes_on(s, x, n) || is_known(s, x, n) || hidden;
            return hidden;
        }

    private:
        double radius(std::size_t s) const { return bodies.solids[s].surface->radius(); }

        bool is_at(std::size_t s, const Vec<double, D>& r, double distance) const {
            const ContactSolid<D>& solid = bodies.solids[s];
            const double reach = radius(s) + distance;
            return dot(r, r) < reach * reach &&
                   solid.surface->is_touched_by(rotated_back(solid.rotation, r), distance);
        }
        bool holds(std::size_t s, const Vec<double, D>& x, double rounding) const {
            return is_at(s, bodies.solids[s].place_of(x, domain), rounding);
        }

        bool meets_another(std::size_t s, const Vec<double, D>& x) const {
            const double gap = near * radius(s);
            for (const std::size_t t : around)
                if (t != s && holds(t, x, gap)) return true;
            for (int axis = 0; axis < D; ++axis)
                for (const double way : {-1.0, 1.0}) {
                    Vec<double, D> r = x - bodies.solids[s].centre;
                    r[axis] += way * domain.length(axis);
                    if (domain.periodic[axis] && is_at(s, r, gap)) return true;
                }
            return false;
        }

        /// Of the facets of solid s through x, each once.
        Array<Vec<double, D>> normals_at(std::size_t s, const Vec<double, D>& x) const {
            const ContactSolid<D>& solid = bodies.solids[s];
            const Vec<double, D> r = rotated_back(solid.rotation, solid.place_of(x, domain));
            Array<Vec<double, D>> normals;
            for (const Facet<D>& facet : *standing[s].facets) {
                if (!(norm(r - nearest_on_facet<D>(facet, r)) < near * radius(s))) continue;
                const Vec<double, D> n = rotated(solid.rotation, normal_of<D>(facet));
                auto same = [&](const Vec<double, D>& m) { return norm(m - n) < near; };
                if (std::ranges::none_of(normals, same)) normals.push_back(n);
            }
            return normals;
        }

        /// Whether just below the plane through x there are bodies on all sides; notes whose faces
        /// lie in that plane.
        bool goes_on(std::size_t s, const Vec<double, D>& x, const Vec<double, D>& n) {
            bool all = true;
            for (const double way : {near, far}) {
                if (!all) return false;
                for (const Vec<double, D>& along : around_normal(n)) {
                    const Vec<double, D> place = x + radius(s) * (way * along - step * n);
                    bool held = holds(s, place, 0.1 * step * radius(s));
                    for (std::size_t k = 0; k < here.size() && !held; ++k) {
                        held = holds(here[k], place, 0.1 * step * radius(s));
                        if (held && way == near) join(s, here[k], x, n);
                    }
                    all = all && held;
                }
            }
            return all;
        }

        /// Whether a body before has a sample there, at a face in the same plane: one edge of both
        /// has each once.
        bool is_known(std::size_t s, const Vec<double, D>& x, const Vec<double, D>& n) const {
            for (const std::size_t t : here) {
                if (t >= s || !standing[t].facets || !holds(t, x, near * radius(s))) continue;
                const auto is_same = [&](const Vec<double, D>& m) { return norm(m - n) < far; };
                if (std::ranges::none_of(normals_at(t, x), is_same)) continue;
                const Array<std::int32_t>& solid = bodies.points.solid;
                const auto number = static_cast<std::int32_t>(t);
                for (std::size_t c = first_point[t]; c < solid.size() && solid[c] == number; ++c)
                    if (norm(nearest_image(domain, bodies.points.position[c] - x)) <
                        near * radius(s))
                        return true;
            }
            return false;
        }

        static Array<Vec<double, D>> around_normal(const Vec<double, D>& n) {
            Array<Vec<double, D>> ways;
            if constexpr (D == 2)
                for (const double way : {-1.0, 1.0}) ways.push_back({{way * n[1], -way * n[0]}});
            else {
                constexpr int count = 16;
                constexpr double beside = std::numbers::pi / count;  // the seams of boxes
                Vec3 axis{};
                axis[std::abs(n[0]) < 0.7 ? 0 : 1] = 1.0;
                const Vec3 across = cross(n, axis), u = (1.0 / norm(across)) * across,
                           v = cross(n, u);
                for (int k = 0; k < count; ++k) {
                    const double angle = beside + 2.0 * std::numbers::pi * k / count;
                    ways.push_back(std::cos(angle) * u + std::sin(angle) * v);
                }
            }
            return ways;
        }

        void join(std::size_t s, std::size_t t, const Vec<double, D>& x, const Vec<double, D>& n) {
            const ContactSolid<D>& other = bodies.solids[t];
            const Vec<double, D> r = rotated_back(other.rotation, other.place_of(x, domain)),
                                 own = rotated_back(other.rotation, n);
            if (!standing[t].facets) return;
            for (const Facet<D>& facet : *standing[t].facets) {
                const Vec<double, D> normal = normal_of<D>(facet);
                if (!(norm(normal - own) < far)) continue;
                if (!(std::abs(dot(r - facet[0], normal)) < 2.0 * step * radius(s))) continue;
                const std::size_t one = face_at(s, x, n),
                                  next = face_at(t, x, rotated(other.rotation, normal));
                unite(faces[one].surface, faces[next].surface, [&](auto&& f) {
                    for (WallFace<D>& face : faces) f(face.surface);
                });
                for (const std::size_t each : {s, t})
                    if (wall[each] < 0) wall[each] = static_cast<std::int32_t>(each);
                unite(wall[s], wall[t], [&](auto&& f) {
                    for (std::int32_t& number : wall) f(number);
                });
                return;
            }
        }

        /// Gives all that have one of two numbers the lower one.
        template <class ForEach>
        static void unite(std::int32_t a, std::int32_t b, const ForEach& for_each) {
            const std::int32_t kept = std::min(a, b), gone = std::max(a, b);
            if (kept == gone) return;
            for_each([&](std::int32_t& number) { number = number == gone ? kept : number; });
        }

        /// Index of the face of solid s in the plane through x.
        std::size_t face_at(std::size_t s, const Vec<double, D>& x, const Vec<double, D>& n) {
            const ContactSolid<D>& solid = bodies.solids[s];
            const Vec<double, D> normal = rotated_back(solid.rotation, n);
            const double height = dot(n, solid.place_of(x, domain));
            for (const std::size_t f : faces_of[s])
                if (norm(faces[f].normal - normal) < far &&
                    std::abs(faces[f].height - height) < near * radius(s))
                    return f;
            const auto surface = static_cast<std::int32_t>(faces.size());
            faces_of[s].push_back(faces.size());
            faces.push_back({static_cast<std::int32_t>(s), surface, normal, height});
            return faces.size() - 1;
        }
    };

    Array<std::uint8_t> hidden_;  // of contact points
    Array<WallFace<D>> faces_;    // by their solids
    Array<std::int32_t> wall_;    // of solids, see ContactSolid
};

}  // namespace doseki
