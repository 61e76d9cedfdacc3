#pragma once
#include <algorithm>
#include <cstdint>
#include <span>

#include "base/array.hpp"

namespace doseki {

/// The union list of one cluster of W consecutive particles: moving neighbours, then fixed ones.
/// Each part is a sequence of runs of entries that share their upper 16 bits: those bits, the
/// number of entries, then their lower 16 bits. Neighbours are stored close to each other, so a run
/// is long and an entry costs little more than two bytes.
class ClusterList {
public:
    ClusterList() = default;
    ClusterList(const std::uint16_t* begin, std::size_t moving_words, std::size_t fixed_words)
        : begin_(begin),
          moving_words_(static_cast<std::uint32_t>(moving_words)),
          fixed_words_(static_cast<std::uint32_t>(fixed_words)) {}

    /// The same without fixed neighbours.
    ClusterList without_fixed() const { return {begin_, moving_words_, 0}; }

    bool empty() const { return words() == 0; }
    bool has_moving() const { return moving_words_ > 0; }
    std::size_t words() const { return std::size_t{moving_words_} + fixed_words_; }

    template <class F>
    [[gnu::always_inline]] void for_each_moving(F&& f) const {
        for_each(begin_, moving_words_, f);
    }
    template <class F>
    [[gnu::always_inline]] void for_each_fixed(F&& f) const {
        for_each(begin_ + moving_words_, fixed_words_, f);
    }

    /// Whether f(entry) holds for a fixed neighbour.
    template <class F>
    bool any_fixed(F&& f) const {
        return any(begin_ + moving_words_, fixed_words_, f);
    }

private:
    template <class F>
    [[gnu::always_inline]] static void for_each(const std::uint16_t* word, std::size_t words,
                                                F& f) {
        auto call = [&f](std::uint32_t entry) __attribute__((always_inline)) {
            f(entry);
            return false;
        };
        any(word, words, call);
    }
    template <class F>
    [[gnu::always_inline]] static bool any(const std::uint16_t* word, std::size_t words, F& f) {
        for (const std::uint16_t* const end = word + words; word != end;) {
            const std::uint32_t upper = static_cast<std::uint32_t>(word[0]) << 16;
            const std::uint16_t* const run_end = word + 2 + word[1];
            for (word += 2; word != run_end; ++word)
                if (f(upper | *word)) return true;
        }
        return false;
    }

    const std::uint16_t* begin_ = nullptr;
    std::uint32_t moving_words_ = 0, fixed_words_ = 0;
};

/// Where the lists of one thread live: blocks that are filled in turn and used again at the next
/// build, so that growing never copies and memory stays within one block of what the lists need.
class ListStorage {
public:
    void clear() { block_ = 0, used_ = 0, entries_ = 0; }

    /// Packs the entries, the first `moving` of which are those of moving neighbours; within each
    /// part they are grouped by their upper bits. The result is valid until clear().
    ClusterList keep(std::span<const std::uint32_t> entries, std::size_t moving) {
        words_.clear();
        pack(entries.first(moving));
        const std::size_t moving_words = words_.size();
        pack(entries.subspan(moving));
        entries_ += entries.size();
        return {store(), moving_words, words_.size() - moving_words};
    }

    std::size_t entries() const { return entries_; }
    std::size_t bytes() const {
        std::size_t bytes = 0;
        for (const auto& block : blocks_) bytes += block.size() * sizeof(std::uint16_t);
        return bytes;
    }

private:
    static constexpr std::size_t smallest_block = 2048, largest_block = 131072;  // words
    static constexpr std::size_t longest_run = 65535;

    void pack(std::span<const std::uint32_t> entries) {
        auto upper = [](std::uint32_t entry) { return entry >> 16; };
        auto by_upper = [upper](std::uint32_t a, std::uint32_t b) { return upper(a) < upper(b); };
        sorted_.assign(entries.begin(), entries.end());
        if (!std::is_sorted(sorted_.begin(), sorted_.end(), by_upper))
            std::stable_sort(sorted_.begin(), sorted_.end(), by_upper);
        for (std::size_t first = 0, last; first < sorted_.size(); first = last) {
            for (last = first; last < sorted_.size() && last - first < longest_run &&
                               upper(sorted_[last]) == upper(sorted_[first]);)
                ++last;
            words_.push_back(static_cast<std::uint16_t>(upper(sorted_[first])));
            words_.push_back(static_cast<std::uint16_t>(last - first));
            for (std::size_t k = first; k < last; ++k)
                words_.push_back(static_cast<std::uint16_t>(sorted_[k]));
        }
    }

    const std::uint16_t* store() {
        while (block_ < blocks_.size() && blocks_[block_].size() - used_ < words_.size())
            ++block_, used_ = 0;
        if (block_ == blocks_.size())
            blocks_.emplace_back(std::max(
                words_.size(),
                std::min(largest_block, smallest_block << std::min<std::size_t>(block_, 16))));
        std::uint16_t* const start = blocks_[block_].data() + used_;
        std::copy(words_.begin(), words_.end(), start);
        used_ += words_.size();
        return start;
    }

    Array<Array<std::uint16_t>> blocks_;
    Array<std::uint16_t> words_;
    Array<std::uint32_t> sorted_;
    std::size_t block_ = 0, used_ = 0, entries_ = 0;
};

}  // namespace doseki
