#include "model/archive.hpp"

#include "model/particles.hpp"

namespace doseki {

void Archive::operator()(const char* name, bool& value) {
    auto number = static_cast<std::uint8_t>(value);
    (*this)(name, number);
    value = number != 0;
}

void Archive::operator()(const char* name, Field<Tag>& tags) {
    Array<std::int64_t> id;
    Array<std::int32_t> body;
    Array<std::int16_t> material;
    Array<std::uint8_t> motion;
    for (const Tag& tag : tags) {
        id.push_back(tag.id), body.push_back(tag.body), material.push_back(tag.material);
        motion.push_back(static_cast<std::uint8_t>(tag.motion));
    }
    (*this)("id", id), (*this)("body", body);
    (*this)("material", material), (*this)("motion", motion);
    if (!loads_) return;
    const std::size_t n = id.size();
    expect_fit(body.size() == n && material.size() == n && motion.size() == n, name);
    tags.resize(n);
    for (std::size_t p = 0; p < n; ++p)
        tags[p] = {id[p], body[p], material[p], static_cast<Motion>(motion[p])};
}

}  // namespace doseki
