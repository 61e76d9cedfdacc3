#include "interface/archive.hpp"

namespace doseki {

void SavingArchive::operator()(const char*, const std::vector<Tag>& tags) {
    TagColumns columns;
    for (const Tag& tag : tags) {
        columns.id.push_back(tag.id), columns.body.push_back(tag.body);
        columns.material.push_back(tag.material);
        columns.motion.push_back(static_cast<std::uint8_t>(tag.motion));
    }
    columns.serialise(*this);
}

void SavingArchive::add(const char* name, Array::Numbers first, std::size_t rows,
                        std::size_t columns) {
    std::visit(
        [&]<class T>(const T* numbers) {
            NewArray<T> copy(columns == 1 ? std::vector{rows} : std::vector{rows, columns});
            std::copy_n(numbers, rows * columns, copy.data());
            arrays[prefix_ + name] = copy;
        },
        first);
}

void LoadingArchive::operator()(const char* name, std::vector<Tag>& tags) {
    TagColumns columns;
    columns.serialise(*this);
    const std::size_t n = columns.id.size();
    expect_fit(
        columns.body.size() == n && columns.material.size() == n && columns.motion.size() == n,
        name);
    tags.resize(n);
    for (std::size_t p = 0; p < n; ++p)
        tags[p] = {columns.id[p], columns.body[p], columns.material[p],
                   static_cast<Motion>(columns.motion[p])};
}

const Array& LoadingArchive::find(const char* name, std::size_t columns) const {
    const Value* value = arrays_.find(prefix_ + name);
    const auto* array = value ? std::get_if<Array>(value) : nullptr;
    expect_fit(array && array->shape.size() >= 1 && array->shape.size() <= 2, name);
    expect_fit((array->shape.size() == 2 ? array->shape[1] : 1) == columns, name);
    return *array;
}

template void Bodies<2>::serialise(SavingArchive&);
template void Bodies<2>::serialise(LoadingArchive&);
template void Bodies<3>::serialise(SavingArchive&);
template void Bodies<3>::serialise(LoadingArchive&);
template void Neighbours<2>::serialise(SavingArchive&);
template void Neighbours<2>::serialise(LoadingArchive&);
template void Neighbours<3>::serialise(SavingArchive&);
template void Neighbours<3>::serialise(LoadingArchive&);
template void OpenBoundaries<2>::serialise(SavingArchive&);
template void OpenBoundaries<2>::serialise(LoadingArchive&);
template void OpenBoundaries<3>::serialise(SavingArchive&);
template void OpenBoundaries<3>::serialise(LoadingArchive&);

}  // namespace doseki
