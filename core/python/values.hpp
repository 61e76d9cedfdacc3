#pragma once
// Python's values to those of core/interface, and back.

#include <nanobind/nanobind.h>

#include "interface/value.hpp"

namespace doseki {

namespace nb = nanobind;

/// Arrays are views, valid for as long as the Python object. Raises TypeError for what has no
/// counterpart.
Value to_value(nb::handle object);
NamedValues to_table(nb::handle dict);
std::vector<NamedValues> to_tables(nb::handle list);

/// Arrays are numpy arrays that own their memory.
nb::object to_python(const Value& value);
nb::dict to_python(const NamedValues& table);

}  // namespace doseki
