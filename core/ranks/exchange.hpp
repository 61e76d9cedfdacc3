#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "base/array.hpp"
#include "base/vec.hpp"
#include "ranks/rank_clock.hpp"

namespace doseki {

using Bytes = Array<std::byte>;

/// Bytes for, or from, another rank.
struct Parcel {
    int rank;
    Bytes content;
};

/// How ranks reach each other, and who owns which part of space. The core packs and unpacks; what
/// carries the bytes is outside it. Every call but those marked "local" is made by all ranks
/// together.
class Exchange {
public:
    Exchange(int rank, int ranks) : rank(rank), ranks(ranks) {}
    virtual ~Exchange() = default;

    const int rank, ranks;

    virtual void largest(std::span<double> values) = 0;  // of each, in place
    virtual void sum(std::span<double> values) = 0;      // of each, in place
    /// The parts of all ranks, which may differ in length, in the order of ranks.
    virtual Array<double> gather(std::span<const double> part) = 0;
    /// Delivers parcels; returns those that came, in the order of ranks.
    virtual Array<Parcel> swap(const Array<Parcel>& parcels) = 0;

    /// Whether space is to be cut anew; `busy`: seconds that this rank has worked since it last
    /// was.
    virtual bool wants_cuts(double busy) = 0;
    /// Cuts space into parts of equal weight.
    virtual void cut(std::span<const double> coordinates, std::span<const double> weights) = 0;
    /// Local: low and high corner of this rank's part.
    virtual Array<double> region() = 0;
    /// Local: the ranks to which points belong.
    virtual Array<int> owners(std::span<const double> coordinates) = 0;

    /// Local: sends and awaits one message for each of `peers`; `ends` are where each ends, in
    /// bytes.
    virtual void start(std::span<const int> peers, std::span<const std::byte> send,
                       std::span<const std::size_t> send_ends, std::span<std::byte> receive,
                       std::span<const std::size_t> receive_ends) = 0;
    /// Local: returns once all that was started has come.
    virtual void finish() = 0;
};

/// The ranks of a run, or the one rank of a run without an Exchange, where every call does nothing.
class Ranks {
public:
    mutable RankClock clock;

    void join(Exchange* exchange) { exchange_ = exchange; }
    bool alone() const { return exchange_ == nullptr; }
    int rank() const { return alone() ? 0 : exchange_->rank; }
    int count() const { return alone() ? 1 : exchange_->ranks; }
    Exchange& exchange() const { return *exchange_; }

    void largest(std::span<double> values) const {
        if (alone()) return;
        const auto timing = clock.measure(Share::wait);
        exchange_->largest(values);
    }
    void sum(std::span<double> values) const {
        if (alone() || values.empty()) return;
        const auto timing = clock.measure(Share::wait);
        exchange_->sum(values);
    }
    double largest(double value) const {
        largest({&value, 1});
        return value;
    }
    double smallest(double value) const { return -largest(-value); }
    double sum(double value) const {
        sum({&value, 1});
        return value;
    }
    Array<double> gather(const Array<double>& part) const {
        if (alone()) return part;
        const auto timing = clock.measure(Share::wait);
        return exchange_->gather(part);
    }

private:
    Exchange* exchange_ = nullptr;
};

/// Vectors as the numbers that they consist of.
template <int D>
std::span<double> numbers_of(Array<Vec<double, D>>& vectors) {
    static_assert(sizeof(Vec<double, D>) == D * sizeof(double));
    return {reinterpret_cast<double*>(vectors.data()), D * vectors.size()};
}

}  // namespace doseki
