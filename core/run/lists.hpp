#pragma once
#include <algorithm>
#include <numeric>
#include <span>
#include <utility>

#include "base/array.hpp"
#include "base/phase_timer.hpp"
#include "cells/list_wear.hpp"
#include "cells/sweeps.hpp"
#include "model/domain.hpp"
#include "model/particles.hpp"
#include "pairs/backend.hpp"
#include "ranks/balance.hpp"
#include "ranks/halo.hpp"
#include "ranks/migration.hpp"
#include "run/any_scheme.hpp"

namespace doseki {

/// The neighbour lists of a run and what keeps them true: the skin, how far particles have gone
/// since the last build, and the ghosts of other ranks. Lists hold as long as no two particles can
/// have come nearer by more than the skin.
template <class Lists>
class RunLists {
public:
    static constexpr int D = Lists::dim;
    using State = Particles<D>;

    RunLists(AnyScheme<Lists>& scheme, const Domain<D>& domain, double skin, bool adapts)
        : scheme_(scheme),
          given_skin_(skin),
          adapts_(adapts),
          lists_(domain),
          wear_(domain),
          halo_(domain) {}

    const Lists& lists() const { return lists_; }
    /// The other ranks and the ghosts that they send.
    Halo<D>& halo() { return halo_; }
    const Halo<D>& halo() const { return halo_; }
    /// Margin of the lists over the smallest support radius, as a fraction of it.
    double skin() const { return skin_; }
    double min_support() const { return min_support_; }
    std::int64_t rebuilds() const { return rebuilds_; }
    std::size_t bytes() const { return lists_.bytes() + wear_.bytes(); }

    /// Particles have gone `distance` at most in one more step; true where lists have to be built.
    /// On several ranks no one knows how far ghosts have gone, so all count as the farthest.
    bool wear(const State& state, double distance) {
        moved_ += distance, approach_ = 2.0 * moved_;
        if (approach_ < skin_width_) return false;
        if (!halo_.alone() || !(approach_ < wear_.reach())) return true;
        approach_ = wear_.approach(state.position);
        return !(approach_ < skin_width_);
    }

    /// Whether lists are new since the last call.
    bool take_news() { return std::exchange(news_, false); }

    /// Cuts space anew where that pays. On one rank this and send_to_owners() do nothing.
    void cut_space(const State& state, PhaseTimer& phases);
    void send_to_owners(State& state) {
        if (halo_.alone()) return;
        const auto timing = halo_.ranks.clock.measure(Share::migrate);
        migrate(state, halo_.ranks.exchange());
    }

    /// Sorts particles and builds lists. `supports()` are the support radii of the particles as
    /// they are stored. The lists have a skin of `least` [m] or more.
    template <class Supports>
    void rebuild(State& state, const Supports& supports, double least, std::int64_t steps,
                 PhaseTimer& phases);

    /// Of a run that has made `steps`.
    void serialise_wear(Archive& archive, std::int64_t steps) {
        archive("rebuilds", rebuilds_), archive("moved", moved_);
        archive("skin_width", skin_width_), archive("skin", skin_);
        archive("rebuild_step", rebuild_step_), archive("approach", approach_);
        archive("min_support", min_support_);
        if (archive.loads())
            expect_fit(0 <= rebuild_step_ && rebuild_step_ <= steps, "rebuild_step");
    }
    void serialise_lists(Archive& archive, const State& state) {
        lists_.serialise(archive);
        lists_.set_size(state.size());
        double reach = wear_.reach();
        Array<Vec<double, D>> built(wear_.positions().begin(), wear_.positions().end());
        archive("lists_reach", reach), archive("lists_position", built);
        if (archive.loads()) {
            expect_fit(built.empty() || built.size() == state.size(), "lists_position");
            expect_fit(built.empty() || reach > 0.0, "lists_reach");
            if (!built.empty()) wear_.start(built, reach);
        }
    }

    /// Throws std::invalid_argument unless the lists are those of particles stored as these are.
    void expect_fit_of(const State& state) const {
        lists_.expect_fit_of(scheme_.width(), wall_flags(state));
    }

private:
    /// Whether faces may meet with water around them, on any rank: those of walls that do not move
    /// never do.
    bool faces_meet(const State& state, std::span<const std::uint8_t> fixed) const {
        const auto faces = state.wall.face.stored();
        const bool moving = std::any_of(faces.begin(), faces.end(),
                                        [](std::int32_t face) { return face >= Face::first_body; });
        const bool wet = std::ranges::find(fixed, 0) != fixed.end();
        const Ranks& ranks = halo_.ranks;
        return ranks.largest(moving ? 1.0 : 0.0) > 0.0 && ranks.largest(wet ? 1.0 : 0.0) > 0.0;
    }
    Field<std::int32_t> faces_with_ghosts(const State& state);
    double cheapest_skin(double min_support, std::int64_t steps) const;
    void append_ghosts(const State& state, Array<Vec<double, D>>& position, Array<double>& support);

    AnyScheme<Lists>& scheme_;
    double given_skin_;
    bool adapts_;
    Lists lists_;
    ListWear<D> wear_;  // of a run on one rank
    Halo<D> halo_;
    double skin_ = 0.0;         // of the smallest support radius
    double skin_width_ = 0.0;   // [m]
    double min_support_ = 0.0;  // [m]
    double moved_ = 0.0;        // since the lists were built, by any particle [m]
    double approach_ = 0.0;     // of any two, at most [m]
    std::int64_t rebuilds_ = 0;
    std::int64_t rebuild_step_ = 0;  // when the lists were built
    bool news_ = false;
    double cut_busy_ = 0.0;  // of the clock, when cutting was last considered [s]
};

template <class Lists>
void RunLists<Lists>::cut_space(const State& state, PhaseTimer& phases) {
    if (halo_.alone()) return;
    const auto timing = halo_.ranks.clock.measure(Share::balance);
    Exchange& exchange = halo_.ranks.exchange();
    const double busy = halo_.ranks.clock.busy() - cut_busy_;
    cut_busy_ += busy;
    if (!exchange.wants_cuts(busy)) return;
    Array<std::uint32_t> everyone(state.size());
    std::iota(everyone.begin(), everyone.end(), 0u);
    const auto cost_of_lists = [this](const ListWords& words, const PassSeconds& seconds) {
        return scheme_.cost_of_lists(words, seconds);
    };
    const auto costs =
        particle_costs(lists_.clusters(), static_cast<std::size_t>(scheme_.width()),
                       lists_.moving(), state.size(), phases, thread_count(), cost_of_lists);
    exchange.cut(coordinates_of(state, everyone), costs);
    phases.restart(true);
}

/// From what the lists that end now have lasted.
template <class Lists>
double RunLists<Lists>::cheapest_skin(double min_support, std::int64_t steps) const {
    const std::int64_t lasted = steps - rebuild_step_;
    if (!adapts_ || skin_ == 0.0) return given_skin_;
    if (lasted == 0) return skin_;
    return scheme_.skin_costs().cheapest_skin(approach_ /
                                              (static_cast<double>(lasted) * min_support));
}

template <class Lists>
template <class Supports>
void RunLists<Lists>::rebuild(State& state, const Supports& supports, double least,
                              std::int64_t steps, PhaseTimer& phases) {
    Array<double> support = supports();
    const Array<std::uint8_t> fixed = wall_flags(state);
    min_support_ = halo_.ranks.smallest(range_of(support).smallest);
    const bool faces_meet = this->faces_meet(state, fixed);
    skin_ = cheapest_skin(min_support_, steps);
    skin_width_ = max(skin_ * min_support_, least);
    if (!halo_.alone()) {
        const auto timing = halo_.ranks.clock.measure(Share::halo);
        halo_.find_exports(state.position, support, fixed, skin_width_, faces_meet);
    }
    {
        const auto timing = phases.measure(Phase::sort);
        const auto order = scheme_.sort(
            lists_, ParticlesToSort<D>{state.position, support, fixed, halo_.exported()});
        reorder(state, order);
        halo_.renumber(order);
    }
    support = supports();
    Array<Vec<double, D>> with_ghosts;
    if (!halo_.alone()) append_ghosts(state, with_ghosts, support);
    const auto timing = phases.measure(Phase::list_build);
    const std::span<const Vec<double, D>> position =
        halo_.alone() ? std::span<const Vec<double, D>>(state.position) : with_ghosts;
    const Field<std::int32_t> faces = faces_meet ? faces_with_ghosts(state) : Field<std::int32_t>{};
    scheme_.build_lists(lists_, position, std::span<const double>(support), skin_width_,
                        std::span<const std::int32_t>(faces));
    if (halo_.alone()) wear_.start(state.position, skin_width_ + range_of(support).largest);
    moved_ = 0.0, approach_ = 0.0, news_ = true, rebuild_step_ = steps;
    ++rebuilds_;
}

/// Faces of the particles here, sorted, and of their ghosts after them.
template <class Lists>
Field<std::int32_t> RunLists<Lists>::faces_with_ghosts(const State& state) {
    Field<std::int32_t> faces;
    static_assert(Face::none == 0, "a field grows by zeros");
    faces.resize(state.size() + halo_.ghosts());
    for (std::size_t p = 0; p < state.size(); ++p) faces[p] = state.wall.face[p];
    halo_.start({halo_column(faces)});
    halo_.finish();
    return faces;
}

/// Positions and supports of the particles here, sorted, and of their ghosts after them.
template <class Lists>
void RunLists<Lists>::append_ghosts(const State& state, Array<Vec<double, D>>& position,
                                    Array<double>& support) {
    const auto timing = halo_.ranks.clock.measure(Share::halo);
    position.assign(state.position.begin(), state.position.end());
    const auto ghosts = halo_.announce(position, support, wall_flags(state));
    const auto order = lists_.sort_ghosts(ghosts.position, ghosts.support, ghosts.is_fixed);
    halo_.place(order, position.size());
    for (const std::uint32_t k : order)
        position.push_back(ghosts.position[k]), support.push_back(ghosts.support[k]);
}

}  // namespace doseki
