// A dam break in 2-D with SPHinXsys: its Riemann solver for weakly compressible water, in the two
// steps of time (advection and sound) that it recommends.
//
//     dam_break WIDTH HEIGHT TANK_LENGTH TANK_HEIGHT DP C0 G END_TIME THREADS
//
// The last lines of its output: "steps N", the steps of sound, then x of each particle of water.

#include <cstdlib>
#include <iostream>

#include "sphinxsys.h"

using namespace SPH;

namespace {

struct Tank : ComplexShape {
    Tank(Vec2d size, Real wall) : ComplexShape("Tank") {
        const Vec2d inner = 0.5 * size, outer = inner + Vec2d(wall, wall);
        add<GeometricShapeBox>(Transform(inner), outer);
        subtract<GeometricShapeBox>(Transform(inner), inner);
    }
};

}  // namespace

int main(int count, char** words) {
    if (count != 10) {
        std::cerr << "dam_break needs nine numbers\n";
        return 1;
    }
    Real given[9];
    for (int k = 0; k < 9; ++k) given[k] = std::atof(words[k + 1]);
    const Vec2d column(given[0], given[1]), tank(given[2], given[3]);
    const Real dp = given[4], sound = given[5], g = given[6], end = given[7], wall = 4 * dp;
    const Vec2d margin(wall, wall);

    SPHSystem system(BoundingBoxd(-margin, tank + margin), dp, size_t(given[8]));
    GeometricShapeBox shape(Transform(Vec2d(0.5 * column)), Vec2d(0.5 * column), "Water");
    FluidBody water(system, shape);
    water.defineMatterMaterial<WeaklyCompressibleFluid>(Real(1000), sound);
    water.generateParticles<BaseParticles, Lattice>();
    SolidBody walls(system, makeShared<Tank>(tank, wall));
    walls.defineMatterMaterial<Solid>();
    walls.generateParticles<BaseParticles, Lattice>();

    InnerRelation inner(water);
    ContactRelation contact(water, {&walls});
    ComplexRelation both(inner, contact);
    Gravity gravity(Vec2d(0, -g));
    SimpleDynamics<GravityForce<Gravity>> weigh(water, gravity);
    SimpleDynamics<NormalDirectionFromBodyShape> normals(walls);
    Dynamics1Level<fluid_dynamics::Integration1stHalfWithWallRiemann> push(inner, contact);
    Dynamics1Level<fluid_dynamics::Integration2ndHalfWithWallRiemann> compress(inner, contact);
    InteractionWithUpdate<fluid_dynamics::DensitySummationComplexFreeSurface> density(inner,
                                                                                      contact);
    ReduceDynamics<fluid_dynamics::AdvectionTimeStep> advection(water, sound / 10);
    ReduceDynamics<fluid_dynamics::AcousticTimeStep> acoustic(water);
    ParticleSorting sorting(water);

    system.initializeSystemCellLinkedLists();
    system.initializeSystemConfigurations();
    normals.exec();
    weigh.exec();
    Real& time = *system.getSystemVariableDataByName<Real>("PhysicalTime");
    long steps = 0;
    for (long outer = 1; time < end; ++outer) {
        const Real whole = std::min(advection.exec(), end - time);
        density.exec();
        for (Real gone = 0; gone < whole * (1 - 1e-9);) {
            const Real dt = std::min(acoustic.exec(), whole - gone);
            push.exec(dt);
            compress.exec(dt);
            gone += dt, time += dt, ++steps;
        }
        if (outer % 100 == 0) sorting.exec();
        water.updateCellLinkedList();
        both.updateConfiguration();
        if (end - time < 1e-9 * end) break;
    }
    std::cout << "steps " << steps << "\n";
    BaseParticles& particles = water.getBaseParticles();
    const Vecd* x = particles.getVariableDataByName<Vecd>("Position");
    for (size_t n = 0; n < particles.TotalRealParticles(); ++n) std::cout << x[n][0] << "\n";
    return 0;
}
