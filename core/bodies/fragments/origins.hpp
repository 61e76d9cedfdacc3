#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/array.hpp"
#include "base/error.hpp"
#include "base/vec.hpp"
#include "model/archive.hpp"

namespace doseki {

/// Where a body comes from. Numbers stay with bodies; -1: of one that the record does not follow,
/// or of none.
struct Origin {
    std::int32_t number = -1, parent = -1;
    double born = 0.0;  // time [s]; of bodies of the start: 0
};

/// How many parts came off others: deformable bodies, and grains of dust.
struct PartCounts {
    std::size_t bodies = 0, dust = 0;
};

/// The origins of bodies of one kind, in their order.
class Origins {
public:
    /// Of none before a run has started.
    Origin operator[](std::size_t k) const { return k < size() ? origins_[k] : Origin{}; }
    std::size_t size() const { return origins_.size(); }
    void add(const Origin& origin) { origins_.push_back(origin); }
    /// Body k is one no more that is told apart.
    void forget(std::size_t k) { origins_[k] = {}; }
    /// Those that came off others.
    std::size_t parts() const {
        return static_cast<std::size_t>(
            std::ranges::count_if(origins_, [](const Origin& o) { return o.parent >= 0; }));
    }

    /// Its arrays begin with `prefix`, see Archive::nested.
    void serialise(Archive& archive) {
        Array<std::int32_t> number, parent;
        Array<double> born;
        for (const Origin& origin : origins_)
            number.push_back(origin.number), parent.push_back(origin.parent),
                born.push_back(origin.born);
        archive("number", number), archive("parent", parent), archive("born", born);
        if (!archive.loads()) return;
        expect_fit(parent.size() == number.size() && born.size() == number.size(), "parent");
        origins_.clear();
        for (std::size_t k = 0; k < number.size(); ++k) {
            expect_fit(number[k] >= -1 && parent[k] >= -1 && std::isfinite(born[k]), "parent");
            origins_.push_back({number[k], parent[k], born[k]});
        }
    }

private:
    Array<Origin> origins_;
};

}  // namespace doseki
