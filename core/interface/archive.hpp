#pragma once
// Where archives keep their arrays: in tables, which a caller writes to files and reads from them.

#include <algorithm>
#include <string>
#include <vector>

#include "interface/value.hpp"
#include "model/archive.hpp"

namespace doseki {

/// Copies the state into new arrays.
class SavingArchive final : public Archive {
public:
    SavingArchive() : Archive(false) {}
    NamedValues arrays;

private:
    void save(const std::string& name, const Rows& rows) override;
    Rows load(const std::string&) const override { return {}; }
};

/// Notes only what the arrays are called.
class NamingArchive final : public Archive {
public:
    NamingArchive() : Archive(false) {}
    std::vector<std::string> names;

private:
    void save(const std::string& name, const Rows&) override { names.push_back(name); }
    Rows load(const std::string&) const override { return {}; }
};

/// Copies arrays made by SavingArchive back; throws std::invalid_argument for others.
class LoadingArchive final : public Archive {
public:
    explicit LoadingArchive(const NamedValues& arrays) : Archive(true), arrays_(arrays) {}

private:
    void save(const std::string&, const Rows&) override {}
    Rows load(const std::string& name) const override;

    const NamedValues& arrays_;
};

inline void SavingArchive::save(const std::string& name, const Rows& rows) {
    std::visit(
        [&]<class T>(const T* numbers) {
            NewArray<T> copy(rows.columns == 1 ? std::vector{rows.rows}
                                               : std::vector{rows.rows, rows.columns});
            std::copy_n(numbers, rows.rows * rows.columns, copy.data());
            arrays[name] = copy;
        },
        rows.first);
}

inline Archive::Rows LoadingArchive::load(const std::string& name) const {
    const Value* value = arrays_.find(name);
    const auto* array = value ? std::get_if<NumberArray>(value) : nullptr;
    if (!array || array->shape.empty() || array->shape.size() > 2) return {};
    return {array->numbers, array->shape[0], array->shape.size() == 2 ? array->shape[1] : 1};
}

}  // namespace doseki
