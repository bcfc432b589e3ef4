//! What the library does, in one program: it is linked once.

mod common;

mod body {
    mod consistency;
    mod contradictions;
    mod cut_bodies;
    mod gaps;
    mod held_volumes;
    mod inf_sup;
    mod layers;
    mod parts;
    mod refusals;
    mod zero_energy;
}
mod contact {
    mod energy;
    mod equilibrium;
    mod friction;
    mod moving_obstacles;
    mod narrow;
    mod obstacles;
}
mod loads {
    mod cavities;
    mod extra_stress;
    mod forces;
    mod pressure;
    mod springs;
}
mod motion {
    mod mass_scaling;
    mod steps;
    mod threads;
    mod time_step;
}
mod statics {
    mod buckling;
    mod equilibrium;
    mod incompressible;
    mod newton;
    mod sensitivity;
    mod unloaded;
}
