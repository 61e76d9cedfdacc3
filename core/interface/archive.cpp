#include "interface/archive.hpp"

#include <algorithm>

namespace doseki {

void SavingArchive::save(const std::string& name, const Rows& rows) {
    std::visit(
        [&]<class T>(const T* numbers) {
            NewArray<T> copy(rows.columns == 1 ? std::vector{rows.rows}
                                               : std::vector{rows.rows, rows.columns});
            std::copy_n(numbers, rows.rows * rows.columns, copy.data());
            arrays[name] = copy;
        },
        rows.first);
}

Archive::Rows LoadingArchive::load(const std::string& name) const {
    const Value* value = arrays_.find(name);
    const auto* array = value ? std::get_if<Array>(value) : nullptr;
    if (!array || array->shape.empty() || array->shape.size() > 2) return {};
    return {array->numbers, array->shape[0], array->shape.size() == 2 ? array->shape[1] : 1};
}

}  // namespace doseki
