#include "interface/options.hpp"

#include <numbers>

#include "interface/reader.hpp"
#include "model/chosen_laws.hpp"

namespace doseki {
namespace {

Material read_material(const NamedValues& table, const std::string& place) {
    Material m{};
    Reader read(table, place);
    read("name", m.name);
    read("law", choice<Law>(m.law, {{"fluid", Law::fluid}, {"solid", Law::solid}}));
    read("rho0", m.rho0), read("speedsound", m.c0);
    MaterialLaws laws{};
    read.law("eos", laws.eos), read.law("rheology", laws.rheology);
    m.laws = Shared<const MaterialLaws>::make(laws);
    read("cavitation_pressure", m.cavitation_pressure);
    read("air_entry_suction", m.air_entry_suction);
    read("shear_modulus", m.shear_modulus), read("yield_strength", m.yield_strength);
    read("cohesion", m.cohesion), read("friction_angle", m.friction_angle);
    m.friction_angle *= std::numbers::pi / 180.0;
    m.contact.members(read);
    read.finish();
    return m;
}

}  // namespace

template <int D>
Setup<D> Setup<D>::read(std::span<const NamedValues> materials, const NamedValues& options) {
    Setup setup;
    for (std::size_t k = 0; k < materials.size(); ++k)
        setup.materials.push_back(
            read_material(materials[k], "materials[" + std::to_string(k) + "]"));
    Reader read(options, "options");
    setup.options.members(read);
    read("domain_min", setup.domain.low), read("domain_max", setup.domain.high);
    read("periodic", setup.domain.periodic);
    read.finish();
    return setup;
}

template struct Setup<2>;
template struct Setup<3>;

}  // namespace doseki
