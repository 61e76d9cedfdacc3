#pragma once
// Where archives keep their arrays: in tables, which a caller writes to files and reads from them.

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

}  // namespace doseki
