#pragma once
// An Exchange whose calls are made by a Python object (parallel/transport.py). Arrays that it is
// given are views of the core's own memory, valid during the call or, from start() on, until
// finish().

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include "ranks/exchange.hpp"

namespace doseki {

class [[gnu::visibility("hidden")]] PythonExchange final : public Exchange {
    using Object = nanobind::object;
    template <class T>
    using View = nanobind::ndarray<nanobind::numpy, T, nanobind::ndim<1>>;

public:
    explicit PythonExchange(Object transport)
        : Exchange(nanobind::cast<int>(transport.attr("rank")),
                   nanobind::cast<int>(transport.attr("ranks"))),
          transport_(std::move(transport)) {}

    void largest(std::span<double> values) override { call("largest", values); }
    void sum(std::span<double> values) override { call("sum", values); }

    Array<double> gather(std::span<const double> part) override {
        const nanobind::gil_scoped_acquire locked;
        return numbers<double>(transport_.attr("gather")(view(part)));
    }

    Array<Parcel> swap(const Array<Parcel>& parcels) override {
        const nanobind::gil_scoped_acquire locked;
        nanobind::dict sent;
        for (const Parcel& parcel : parcels)
            sent[nanobind::int_(parcel.rank)] = view(std::span(parcel.content));
        Array<Parcel> came;
        for (const auto& [rank, content] :
             nanobind::cast<nanobind::dict>(transport_.attr("swap")(sent)))
            came.push_back({nanobind::cast<int>(rank), numbers<std::byte, std::uint8_t>(content)});
        return came;
    }

    bool wants_cuts(double busy) override {
        const nanobind::gil_scoped_acquire locked;
        return nanobind::cast<bool>(transport_.attr("wants_cuts")(busy));
    }
    void cut(std::span<const double> coordinates, std::span<const double> weights) override {
        call("cut", coordinates, weights);
    }
    Array<double> region() override {
        const nanobind::gil_scoped_acquire locked;
        return numbers<double>(transport_.attr("region")());
    }
    Array<int> owners(std::span<const double> coordinates) override {
        const nanobind::gil_scoped_acquire locked;
        return numbers<int>(transport_.attr("owners")(view(coordinates)));
    }

    void start(std::span<const int> peers, std::span<const std::byte> send,
               std::span<const std::size_t> send_ends, std::span<std::byte> receive,
               std::span<const std::size_t> receive_ends) override {
        call("start", peers, send, send_ends, receive, receive_ends);
    }
    void finish() override { call("finish"); }

private:
    /// As numpy sees it, without a copy; bytes are uint8.
    template <class T>
    static Object view(std::span<T> values) {
        using Number = std::conditional_t<
            std::is_same_v<std::remove_const_t<T>, std::byte>,
            std::conditional_t<std::is_const_v<T>, const std::uint8_t, std::uint8_t>, T>;
        static std::remove_const_t<Number> nothing{};
        const std::size_t shape[] = {values.size()};
        const void* const data =
            values.empty() ? &nothing : static_cast<const void*>(values.data());
        return nanobind::cast(View<Number>(const_cast<void*>(data), 1, shape, nanobind::none()),
                              nanobind::rv_policy::reference);
    }

    template <class T, class Number = T>
    static Array<T> numbers(const nanobind::handle& array) {
        const auto values = nanobind::cast<
            nanobind::ndarray<const Number, nanobind::c_contig, nanobind::device::cpu>>(array);
        const auto* const first = reinterpret_cast<const T*>(values.data());
        return Array<T>(first, first + values.size());
    }

    template <class... Values>
    void call(const char* name, Values... values) {
        const nanobind::gil_scoped_acquire locked;
        transport_.attr(name)(view(values)...);
    }

    Object transport_;
};

}  // namespace doseki
