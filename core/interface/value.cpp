#include "interface/value.hpp"

namespace doseki {

NamedValues::NamedValues() = default;
NamedValues::NamedValues(const NamedValues&) = default;
NamedValues::NamedValues(NamedValues&&) noexcept = default;
NamedValues& NamedValues::operator=(const NamedValues&) = default;
NamedValues& NamedValues::operator=(NamedValues&&) noexcept = default;
NamedValues::~NamedValues() = default;

Value& NamedValues::operator[](std::string_view name) {
    for (auto& [known, value] : items_)
        if (known == name) return value;
    return items_.emplace_back(std::string(name), Value{}).second;
}

const Value* NamedValues::find(std::string_view name) const {
    for (const auto& [known, value] : items_)
        if (known == name) return &value;
    return nullptr;
}

}  // namespace doseki
