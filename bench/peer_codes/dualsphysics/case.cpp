// Writes and reads particle files of DualSPHysics with its own classes.
//
//     case write NAME < particles     NAME.bi4; fixed particles first
//     case read FOLDER PART           x of each fluid particle, on one line each
//
// Particles are text: numbers of all and of fixed ones, then dp, h, B, rho0, gamma and the mass of
// one, then x y z vx vy vz of each.

#include <cstdlib>
#include <iostream>
#include <string>
#include <vector>

#include "JBinaryData.h"
#include "JPartDataBi4.h"

namespace {

struct Case {
    unsigned all = 0, fixed = 0;
    double dp = 0, h = 0, stiffness = 0, density = 0, gamma = 0, mass = 0;
    std::vector<unsigned> id;
    std::vector<tdouble3> position;
    std::vector<tfloat3> velocity;
};

Case read_case(std::istream& in) {
    Case c;
    in >> c.all >> c.fixed >> c.dp >> c.h >> c.stiffness >> c.density >> c.gamma >> c.mass;
    for (unsigned n = 0; n < c.all; ++n) {
        tdouble3 x, v;
        in >> x.x >> x.y >> x.z >> v.x >> v.y >> v.z;
        c.id.push_back(n), c.position.push_back(x);
        c.velocity.push_back(TFloat3(float(v.x), float(v.y), float(v.z)));
    }
    if (!in) throw std::string("the particles end too early");
    return c;
}

void write_case(const std::string& name) {
    const Case c = read_case(std::cin);
    tdouble3 low = c.position.front(), high = low;
    for (const tdouble3& x : c.position) low = MinValues(low, x), high = MaxValues(high, x);
    const std::vector<float> density(c.all, float(c.density));
    JPartDataBi4 file;
    file.ConfigBasic(0, 1, "", "doseki", name, true, 0.0, "");
    file.ConfigParticles(c.all, c.fixed, 0, 0, c.all - c.fixed, low, high, false, false);
    file.ConfigCtes(c.dp, c.h, c.stiffness, c.density, c.gamma, c.mass, c.mass);
    file.AddPartInfo(0, 0.0, c.all, 0, 0, 0.0, low, high);
    file.AddPartData(c.all, c.id.data(), c.position.data(), c.velocity.data(), density.data());
    file.SaveFileCase(name);
}

void read_part(const std::string& folder, unsigned part) {
    JPartDataBi4 file;
    file.LoadFilePart(folder, part);
    const unsigned count = file.Get_Npok();
    std::vector<unsigned> id(count);
    file.Get_Idp(count, id.data());
    std::vector<tfloat3> position(count);
    file.Get_Pos(count, position.data());
    for (unsigned n = 0; n < count; ++n)
        if (id[n] >= file.Get_CaseNfixed()) std::cout << position[n].x << "\n";
}

}  // namespace

int main(int count, char** words) try {
    const std::string verb = count > 1 ? words[1] : "";
    if (verb == "write" && count == 3)
        write_case(words[2]);
    else if (verb == "read" && count == 4)
        read_part(words[2], unsigned(std::atoi(words[3])));
    else
        throw std::string("case write NAME, or case read FOLDER PART");
    return 0;
} catch (const std::string& message) {
    std::cerr << message << "\n";
    return 1;
}
