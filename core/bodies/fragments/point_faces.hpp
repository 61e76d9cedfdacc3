#pragma once
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "base/array.hpp"
#include "base/matrix.hpp"
#include "bodies/elastic/division.hpp"
#include "model/archive.hpp"
#include "model/particles.hpp"
#include "physics/wall.hpp"

namespace doseki {

/// What points of deformable bodies are of the surface of their body, at rest; see WallState.
template <int D>
struct PointFaces {
    Array<Vec<double, D>> normal, area;
    Array<Mat<double, D>> edge_normals;
    Array<double> depth;       // [m]
    Array<std::int32_t> face;  // see Face

    void add(const WallState<D>& wall, std::size_t p) {
        normal.push_back(wall.normal[p]), area.push_back(wall.area[p]);
        edge_normals.push_back(wall.edge_normals[p]);
        depth.push_back(wall.depth[p]), face.push_back(wall.face[p]);
    }
    template <class Sort>
    void sort(const Sort& sorted) {
        normal = sorted(normal), area = sorted(area), edge_normals = sorted(edge_normals);
        depth = sorted(depth), face = sorted(face);
    }
    void serialise(Archive& archive) {
        archive("normal", normal), archive("area", area), archive("edge_normals", edge_normals);
        archive("depth", depth), archive("face", face);
    }
    bool fit(std::size_t points) const {
        return normal.size() == points && area.size() == points && edge_normals.size() == points &&
               depth.size() == points && face.size() == points;
    }

    /// Whether films may press on any.
    bool any() const {
        return std::ranges::any_of(face, [](std::int32_t of) { return of != Face::none; });
    }
    /// The faces of each body have one number; of one without films none.
    Array<std::int32_t> numbers(std::span<const std::int32_t> body, std::size_t bodies) const {
        Array<std::int32_t> number(bodies, std::int32_t{Face::none});
        for (std::size_t p = 0; p < body.size(); ++p)
            if (body[p] >= 0) {
                std::int32_t& own = number[static_cast<std::size_t>(body[p])];
                own = std::max(own, std::abs(face[p]));
            }
        return number;
    }
    /// Numbers the faces of new bodies, and returns the numbers of all. `before`: the body that
    /// each point was of, one of `bodies`.
    Array<std::int32_t> renumber(std::span<const std::int32_t> before, std::size_t bodies,
                                 const Division& parts) {
        Array<std::int32_t> number = numbers(before, bodies);
        for (const std::int32_t parent : parts.parent) {
            const bool has_films = number[static_cast<std::size_t>(parent)] != Face::none;
            const auto own = static_cast<std::int32_t>(number.size());
            number.push_back(has_films ? Face::first_part + own : std::int32_t{Face::none});
        }
        for (std::size_t p = 0; p < face.size(); ++p)
            if (const std::int32_t now = parts.body[p]; now >= static_cast<std::int32_t>(bodies)) {
                const std::int32_t own = number[static_cast<std::size_t>(now)];
                face[p] = face[p] > Face::none ? own : face[p] < Face::none ? -own : Face::none;
            }
        return number;
    }
};

}  // namespace doseki
