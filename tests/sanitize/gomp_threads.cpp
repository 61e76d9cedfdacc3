// The few functions of GCC's OpenMP runtime that the core calls, on plain threads. The thread
// sanitiser cannot see inside libgomp and takes its barriers for races; it sees everything here, so
// a race that it reports is one of the core.

#include <condition_variable>
#include <mutex>
#include <thread>

namespace {

// One parallel region: its loop, shared by its threads.
struct Team {
    std::mutex lock;
    int size = 1;
    long next = 0, end = 0, increment = 1, chunk = 1;
    bool loop_started = false;
};

int wanted_threads = 4;
std::mutex atomic_lock;
thread_local Team* team = nullptr;
thread_local int number = 0;

using Work = void (*)(void*);

void work_as(Team& shared, Work work, void* data, int own) {
    Team* const outer = team;
    const int outer_number = number;
    team = &shared, number = own;
    work(data);
    team = outer, number = outer_number;
}

// Threads that wait for regions: making them for each takes longer than what most of them do. The
// lock orders a region after what came before it, and what follows after the region.
class Crew {
public:
    void run(Team& shared, Work work, void* data) {
        {
            const std::lock_guard hold(lock_);
            for (; hired_ + 1 < shared.size; ++hired_)
                std::thread([this, own = hired_ + 1, seen = regions_] {
                    serve(own, seen);
                }).detach();
            team_ = &shared, work_ = work, data_ = data;
            busy_ = shared.size - 1, ++regions_;
        }
        begins_.notify_all();
        work_as(shared, work, data, 0);
        std::unique_lock hold(lock_);
        ends_.wait(hold, [this] { return busy_ == 0; });
    }

private:
    // The thread of this number, which has taken part in the regions before `seen`.
    [[noreturn]] void serve(int own, long seen) {
        for (;;) {
            std::unique_lock hold(lock_);
            begins_.wait(hold, [&] { return regions_ > seen; });
            seen = regions_;
            if (own >= team_->size) continue;
            Team& shared = *team_;
            const Work work = work_;
            void* const data = data_;
            hold.unlock();
            work_as(shared, work, data, own);
            hold.lock();
            if (--busy_ == 0) ends_.notify_one();
        }
    }

    std::mutex lock_;
    std::condition_variable begins_, ends_;
    Team* team_ = nullptr;
    Work work_ = nullptr;
    void* data_ = nullptr;
    long regions_ = 0;
    int hired_ = 0, busy_ = 0;
};

void run(Team& shared, Work work, void* data) {
    if (shared.size == 1 || team) {  // a region within another one is one thread's
        shared.size = 1;
        work_as(shared, work, data, 0);
        return;
    }
    static Crew* const crew = new Crew;  // never destroyed: its threads wait to the end
    crew->run(shared, work, data);
}

int size_of(unsigned asked) { return asked ? static_cast<int>(asked) : wanted_threads; }

bool next_chunk(long* first, long* last) {
    const std::lock_guard hold(team->lock);
    if (team->next >= team->end) return false;
    *first = team->next;
    team->next += team->chunk * team->increment;
    *last = team->next < team->end ? team->next : team->end;
    return true;
}

}  // namespace

extern "C" {

void omp_set_num_threads(int n) { wanted_threads = n; }
int omp_get_max_threads() { return wanted_threads; }
int omp_get_num_threads() { return team ? team->size : 1; }
int omp_get_thread_num() { return team ? number : 0; }

void GOMP_parallel(Work work, void* data, unsigned threads, unsigned) {
    Team shared;
    shared.size = size_of(threads);
    run(shared, work, data);
}

void GOMP_parallel_loop_nonmonotonic_dynamic(Work work, void* data, unsigned threads, long first,
                                             long last, long increment, long chunk, unsigned) {
    Team shared;
    shared.size = size_of(threads);
    shared.next = first, shared.end = last, shared.increment = increment, shared.chunk = chunk;
    run(shared, work, data);
}

bool GOMP_loop_nonmonotonic_dynamic_next(long* first, long* last) {
    return next_chunk(first, last);
}

// A loop inside a region that is already parallel; the core has at most one in a region.
bool GOMP_loop_nonmonotonic_dynamic_start(long first, long last, long increment, long chunk,
                                          long* from, long* to) {
    {
        const std::lock_guard hold(team->lock);
        if (!team->loop_started)
            team->next = first, team->end = last, team->increment = increment, team->chunk = chunk;
        team->loop_started = true;
    }
    return next_chunk(from, to);
}

// The unsigned forms that loops over std::size_t use.
using Size = unsigned long long;
bool GOMP_loop_ull_nonmonotonic_dynamic_next(Size* first, Size* last) {
    return next_chunk(reinterpret_cast<long*>(first), reinterpret_cast<long*>(last));
}
bool GOMP_loop_ull_nonmonotonic_dynamic_start(bool, Size first, Size last, Size increment,
                                              Size chunk, Size* from, Size* to) {
    return GOMP_loop_nonmonotonic_dynamic_start(
        static_cast<long>(first), static_cast<long>(last), static_cast<long>(increment),
        static_cast<long>(chunk), reinterpret_cast<long*>(from), reinterpret_cast<long*>(to));
}

void GOMP_loop_end_nowait() {}
// Regions end right after their loop, where run() joins the threads.
void GOMP_loop_end() {}
void GOMP_atomic_start() { atomic_lock.lock(); }
void GOMP_atomic_end() { atomic_lock.unlock(); }

}  // extern "C"
