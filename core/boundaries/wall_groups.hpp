#pragma once
#include <algorithm>
#include <cstdint>
#include <span>

#include "base/array.hpp"
#include "model/archive.hpp"

namespace doseki {

/// A set of groups of wall particles: for each layer of a tile a word that has a bit for each
/// column. Tiles without groups are not in it.
class WallGroups {
public:
    using Word = std::uint64_t;
    struct Group {
        std::int64_t tile;
        int column, layer;
    };

    explicit WallGroups(int layers = 0) : layers_(static_cast<std::size_t>(layers)) {}

    std::size_t size() const { return tiles_.size(); }  // in tiles
    std::int64_t tile(std::size_t k) const { return tiles_[k]; }
    /// The first rank that wants groups of tile k.
    int rank(std::size_t k) const { return ranks_[k]; }

    /// Where a tile is among the tiles; size() where it is not.
    std::size_t place(std::int64_t tile) const {
        const auto found = std::lower_bound(tiles_.begin(), tiles_.end(), tile);
        return found != tiles_.end() && *found == tile
                   ? static_cast<std::size_t>(found - tiles_.begin())
                   : size();
    }
    /// Whether it has the group of column and layer `of` of tile k.
    template <class Of>
    bool has(std::size_t k, const Of& of) const {
        const auto layer = static_cast<std::size_t>(of.layer);
        return k < size() && layer < layers_ && of.column >= 0 &&
               words_[k * layers_ + layer] >> of.column & 1;
    }
    bool has(const Group& group) const { return has(place(group.tile), group); }
    /// Whether it has all groups of the other.
    bool contains(const WallGroups& other) const {
        for (std::size_t k = 0; k < other.size(); ++k) {
            const std::size_t own = place(other.tile(k));
            if (own == size()) return false;
            for (std::size_t layer = 0; layer < layers_; ++layer)
                if (other.words_[k * layers_ + layer] & ~words_[own * layers_ + layer])
                    return false;
        }
        return true;
    }

    /// Adds words, one for each layer, of a tile behind all others; nothing where all are 0.
    void append(std::int64_t tile, std::span<const Word> words, int rank = 0) {
        if (std::all_of(words.begin(), words.end(), [](Word word) { return word == 0; })) return;
        tiles_.push_back(tile), ranks_.push_back(rank);
        words_.insert(words_.end(), words.begin(), words.end());
    }

    /// The sets of several ranks as one, from what as_numbers() made of each, one after another.
    static WallGroups merged(const Array<double>& numbers, int layers) {
        const std::size_t row = 2 + 2 * static_cast<std::size_t>(layers);
        Array<const double*> rows;
        for (std::size_t k = 0; k < numbers.size(); k += row) rows.push_back(&numbers[k]);
        // Stable: the first of several ranks stays the first.
        std::stable_sort(rows.begin(), rows.end(),
                         [](const double* a, const double* b) { return a[0] < b[0]; });
        WallGroups groups(layers);
        Array<Word> words(static_cast<std::size_t>(layers));
        for (std::size_t k = 0, next = 0; k < rows.size(); k = next) {
            std::fill(words.begin(), words.end(), 0);
            for (next = k; next < rows.size() && rows[next][0] == rows[k][0]; ++next)
                for (std::size_t layer = 0; layer < words.size(); ++layer)
                    words[layer] |= word_of(rows[next] + 2 + 2 * layer);
            groups.append(static_cast<std::int64_t>(rows[k][0]), words,
                          static_cast<int>(rows[k][1]));
        }
        return groups;
    }
    /// A row for each tile: its number, the rank, and each word in two halves, which doubles hold.
    Array<double> as_numbers(int rank) const {
        Array<double> numbers;
        for (std::size_t k = 0; k < size(); ++k) {
            numbers.push_back(static_cast<double>(tiles_[k])), numbers.push_back(rank);
            for (std::size_t layer = 0; layer < layers_; ++layer) {
                const Word word = words_[k * layers_ + layer];
                numbers.push_back(static_cast<double>(word >> half));
                numbers.push_back(static_cast<double>(word & low_half));
            }
        }
        return numbers;
    }

    void serialise(Archive& archive) {
        archive("terrain_tiles", tiles_), archive("terrain_groups", words_);
        if (archive.loads()) ranks_.assign(tiles_.size(), 0);
    }
    /// Throws std::invalid_argument unless these are groups of so many tiles of so many columns.
    void expect_fit(std::int64_t tiles, int columns) const {
        for (std::size_t k = 0; k < size(); ++k) {
            expect_index(tiles_[k], static_cast<std::size_t>(tiles), "terrain_tiles");
            doseki::expect_fit(k == 0 || tiles_[k - 1] < tiles_[k], "terrain_tiles");
        }
        doseki::expect_fit(words_.size() == size() * layers_, "terrain_groups");
        for (const Word word : words_)
            doseki::expect_fit(columns == 64 || word >> columns == 0, "terrain_groups");
    }

private:
    static constexpr int half = 32;
    static constexpr Word low_half = 0xffffffffu;

    static Word word_of(const double* halves) {
        return static_cast<Word>(halves[0]) << half | static_cast<Word>(halves[1]);
    }

    std::size_t layers_;
    Array<std::int64_t> tiles_;  // in their order
    Array<std::int32_t> ranks_;
    Array<Word> words_;  // layer by layer
};

}  // namespace doseki
