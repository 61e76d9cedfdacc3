#pragma once
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

namespace doseki {

/// Where the lists of one thread live: blocks that are filled in turn and used again at the next
/// build, so that growing never copies and memory stays within one block of what the lists need.
class ListStorage {
public:
    void clear() { block_ = 0, used_ = 0, entries_ = 0; }

    /// Keeps a copy of `list`; the result is valid until clear().
    const std::uint32_t* keep(std::span<const std::uint32_t> list) {
        while (block_ < blocks_.size() && blocks_[block_].size() - used_ < list.size()) ++block_, used_ = 0;
        if (block_ == blocks_.size()) blocks_.emplace_back(std::max(list.size(), std::min(largest_block, smallest_block << block_)));
        std::uint32_t* const start = blocks_[block_].data() + used_;
        std::copy(list.begin(), list.end(), start);
        used_ += list.size();
        entries_ += list.size();
        return start;
    }

    std::size_t entries() const { return entries_; }
    std::size_t bytes() const {
        std::size_t bytes = 0;
        for (const auto& block : blocks_) bytes += block.size() * sizeof(std::uint32_t);
        return bytes;
    }

private:
    static constexpr std::size_t smallest_block = 1024, largest_block = 65536;    // entries
    std::vector<std::vector<std::uint32_t>> blocks_;
    std::size_t block_ = 0, used_ = 0, entries_ = 0;
};

}  // namespace doseki
