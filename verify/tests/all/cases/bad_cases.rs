//! Every mistake in a case file is reported with its place, its key and what
//! was expected.

use mtled_case::scene::{Diagnostic, read_case};
use std::path::{Path, PathBuf};

/// File, line, key, part of the message.
type Expected = (&'static str, usize, &'static str, &'static str);

#[rustfmt::skip]
const BAD_CASES: &[Expected] = &[
    ("syntax_error", 7, "", "unclosed table"),
    ("duplicate_key", 10, "", "duplicate key"),
    ("unknown_key", 9, "material.tissue.densty", "did you mean `density`?"),
    ("unknown_table", 26, "solver", "is not a key that is known here; expected one of title"),
    ("unknown_law", 8, "material.tissue.law", "did you mean `neo_hookean_log_j`?"),
    ("unknown_shape", 5, "geometry.shape", "`cube` is not a choice that is known here"),
    ("unknown_key_in_shape", 5, "geometry.shape.box.mx", "did you mean `max`?"),
    ("missing_law", 7, "material.tissue.law", "is missing"),
    ("missing_time", 1, "time", "is missing"),
    ("missing_title", 1, "title", "is missing"),
    ("missing_extent", 17, "prescribe[0].of", "is missing"),
    ("wrong_type", 15, "discretisation.spacing", "expected a number"),
    ("short_vector", 5, "geometry.shape.box.max", "expected an array of length 3"),
    ("not_a_number", 9, "material.tissue.density", "must be a finite number"),
    ("infinite_offset", 29, "obstacle[0].offset", "is inf; it must be a finite number"),
    ("incompressible", 11, "material.tissue.poisson_ratio", "is 0.5; it must lie in -1 < ν < 0.5"),
    ("unstable_rubber", 12, "material.tissue.poisson_ratio", "loses its stiffness in tension; use ν ≥ 0.4000"),
    ("mixed_constants", 11, "material.tissue.lame_modulus", "young_modulus with lame_modulus cannot be used"),
    ("missing_constant", 10, "material.tissue.young_modulus", "young_modulus cannot be used; give young_modulus and poisson_ratio"),
    ("no_constants", 7, "material.tissue", "has no elastic constants"),
    ("rubber_constant_elsewhere", 12, "material.tissue.A", "belongs to law = \"mooney_rivlin\""),
    ("volumetric_elsewhere", 12, "material.tissue.volumetric", "belongs to law = \"neo_hookean_isochoric\" or \"ogden\""),
    ("spring_without_stiffness", 12, "spring[0].normal", "is 0, and so is tangential"),
    ("spring_negative", 15, "spring[0].normal", "must not be negative"),
    ("fluid_without_modulus", 15, "cavity[0].fluid.bulk_modulus", "must be positive"),
    ("fluid_inflow_infinite", 15, "cavity[0].fluid.inflow", "must be a"),
    ("fluid_amplitude", 15, "cavity[0].fluid.amplitude.linear.duration", "must be positive"),
    ("cavity_named_as_spring", 17, "cavity[0].name", "bed"),
    ("bad_formula", 21, "prescribe[0].formula.z", "`r` is not known here; a formula depends on x, y and z"),
    ("data_without_header", 21, "prescribe[0].data.file", "expected a header that names x, y, z, ux, uy and uz"),
    ("data_without_frame", 21, "prescribe[0].data.file", "NIfTI does not say along what its vectors are measured"),
    ("frame_of_a_table", 21, "prescribe[0].data.frame", "belongs to images (NIfTI, NRRD); remove it"),
    ("field_of_an_image", 21, "prescribe[0].data.field", "belongs to VTU files; remove it"),
    ("ogden_without_terms", 7, "material.tissue.terms", "is missing; ogden needs terms"),
    ("ogden_exponent", 10, "material.tissue.terms[1].alpha", "is 0; it must be finite and not 0"),
    ("ogden_constants", 11, "material.tissue.young_modulus", "does not belong to ogden, which takes terms and either"),
    ("terms_elsewhere", 12, "material.tissue.terms", "belongs to law = \"ogden\""),
    ("acceleration_twice", 19, "body_force[0].formula", "stands beside acceleration; give one of them"),
    ("velocity_missing", 17, "initial_velocity[0].velocity", "is missing; give it, or a formula"),
    ("traction_formula", 20, "traction[0].formula.z", "is not a formula"),
    ("fibres_missing", 7, "material.tissue.fibres", "is missing; the law needs it"),
    ("fibres_of_length_0", 12, "material.tissue.fibres.direction", "is zero; it must be a direction"),
    ("fibres_elsewhere", 12, "material.tissue.fibres", "belongs to laws with fibres"),
    ("sheets_missing", 7, "material.tissue.sheets", "is missing; the law needs it"),
    ("two_directions", 12, "material.tissue.fibres", "takes one of direction, formula and data"),
    ("constant_missing", 10, "material.tissue.constants.b_fs", "is missing; guccione needs it"),
    ("constant_unknown", 10, "material.tissue.constants.b_f", "there is no constant of demiray called `b_f`"),
    ("constants_missing", 7, "material.tissue.constants", "is missing; yeoh needs C1 [Pa], C2 [Pa], C3 [Pa]"),
    ("constants_elsewhere", 12, "material.tissue.constants", "belongs to yeoh, demiray and laws with fibres"),
    ("yeoh_unstable", 10, "material.tissue.constants.C1", "loses its stiffness at large stretches"),
    ("dispersion", 10, "material.tissue.constants.kappa", "is 0.4; it must lie in 0 ≤ κ ≤ 1/3"),
    ("muscle_poisson_ratio", 11, "material.tissue.poisson_ratio", "does not belong to guccione, which takes constants and bulk_modulus"),
    ("fibres_formula", 12, "material.tissue.fibres.formula.x", "is not known here"),
    ("prony_sum", 12, "material.tissue.prony", "the parts g of prony sum to 1.1; they must sum to less than 1"),
    ("prony_negative_time", 12, "material.tissue.prony[1].tau", "is -2; it must be positive"),
    ("prony_elsewhere", 12, "material.tissue.prony", "which neo_hookean_log_j does not have"),
    ("prony_by_relaxation", 26, "time.solver", "has no time for a material with viscosity"),
    ("prony_empty", 12, "material.tissue.prony", "has 0 terms; it takes one to 6"),
    ("friction_negative", 20, "obstacle[0].friction.coulomb", "is -0.3; it must not be negative"),
    ("friction_by_newton", 27, "time.solver", "no friction that slides: use relaxation, or a motion"),
    ("motion_of_nothing", 23, "obstacle[0].motion[1]", "needs a displacement or a rotation"),
    ("motion_twice", 22, "obstacle[0].motion[0].rotation", "make it a motion of its own"),
    ("parts_without_viscosity", 25, "time.parts", "belongs to materials with viscosity"),
    ("no_parts", 26, "time.parts", "is 0; it must be at least 1"),
    ("active_without_fibres", 7, "material.tissue.fibres", "is missing; active_stress needs it"),
    ("active_infinite", 13, "material.tissue.active_stress.tension", "is inf; it must be a finite number"),
    ("negative_density", 9, "material.tissue.density", "is -1000; it must be positive"),
    ("negative_stiffness", 10, "material.tissue.young_modulus", "is -3000; it must be positive"),
    ("several_materials_no_region", 7, "material", "say with [[region]]"),
    ("unknown_material", 10, "region[0].material", "did you mean `tissue`?"),
    ("negative_radius", 5, "geometry.shape.sphere.radius", "is -0.1; it must be positive"),
    ("empty_box", 5, "geometry.shape.box.max[1]", "must be larger than min, which is 0"),
    ("crossed_polygon", 5, "geometry.shape", "cross or touch"),
    ("unbounded_body", 5, "geometry.shape", "is unbounded"),
    ("zero_normal", 20, "prescribe[0].where.plane.normal", "is zero; it must be a direction"),
    ("facing_in_degrees", 20, "prescribe[0].where.facing.angle", "is 20; it must lie in 0 < angle < π, in radians"),
    ("empty_union", 20, "prescribe[0].where.union", "is empty"),
    ("negative_spacing", 15, "discretisation.spacing", "is -0.02; it must be positive"),
    ("missing_spacing", 13, "discretisation.spacing", "is missing"),
    ("coarse_spacing", 15, "discretisation.spacing", "must not be larger than the body, which is 0.1 m"),
    ("large_jitter", 16, "discretisation.jitter", "must lie in 0 ≤ jitter < 0.5"),
    ("regularisation_elsewhere", 16, "discretisation.regularisation", "belongs to basis = \"modified_quadratic\""),
    ("no_regularisation", 17, "discretisation.regularisation", "is 0; it must lie in 0 < regularisation ≤ 1"),
    ("jitter_elsewhere", 16, "discretisation.jitter", "belongs to cloud = \"jittered\""),
    ("small_dilation", 16, "discretisation.dilation", "it must be larger than 1"),
    ("no_gauss_points", 16, "discretisation.grid.gauss_points", "is 0; it must be 1 to 5"),
    ("many_gauss_points", 16, "discretisation.grid.gauss_points", "is 6; it must be 1 to 5"),
    ("two_cell_sizes", 16, "discretisation.grid.cells_per_spacing", "cannot be given together with cell"),
    ("missing_nodes_file", 15, "discretisation.file", "no_such_nodes.csv: the file cannot be read"),
    ("nothing_prescribed", 17, "prescribe[0]", "prescribes nothing"),
    ("no_component", 21, "prescribe[0].displacement", "has no component"),
    ("two_motions", 22, "prescribe[0].rotation", "cannot be given together with displacement"),
    ("empty_table", 22, "prescribe[0].amplitude.table", "is empty"),
    ("times_decrease", 22, "prescribe[0].amplitude.table[2]", "has time 1 after 1; times must increase"),
    ("negative_duration", 22, "prescribe[0].amplitude.smooth.duration", "must be positive"),
    ("early_release", 22, "prescribe[0].release", "is 0; it must be positive"),
    ("duplicate_name", 27, "traction[0].name", "`bottom` is already the name of prescribe[0]"),
    ("missing_end", 23, "time.end", "is missing"),
    ("negative_end", 25, "time.end", "is -1; it must be positive"),
    ("large_safety_factor", 25, "time.safety_factor", "is 1.1; it must lie in (0, 1]"),
    ("small_mass_scaling", 26, "time.mass_scaling", "is 0.5; it must be 1 or more"),
    ("negative_damping", 26, "time.damping", "must not be negative"),
    ("damping_elsewhere", 25, "time.damping", "belongs to method = \"dynamic\""),
    ("unknown_region", 28, "probe[0].centre_of_mass", "did you mean `body`?"),
    ("empty_probe", 26, "probe[0]", "exactly one of point, points, lattice, centre_of_mass"),
    ("points_without_unit", 28, "probe[0].points.file", "with `unit` in the case file, or all with their unit"),
    ("points_in_metres", 26, "probe[0]", "`marks.tip` at (50, 50, 50) m lies 86.429 m outside the body, and so do 1 more of 3"),
    ("probe_outside", 26, "probe[0]", "lies 0.100 m outside the body; the body lies between (0.000"),
    ("plane_in_3d", 4, "plane", "belongs to dimension = \"plane_strain\""),
    ("missing_plane", 3, "dimension", "needs a [plane]"),
    ("z_in_plane_strain", 26, "prescribe[0].displacement.z", "there is no motion along z in plane strain"),
    ("gravity_out_of_plane", 32, "body_force[0].acceleration", "it must be 0 in plane strain"),
    ("tilted_axis", 26, "prescribe[0].rotation.axis", "in plane strain it must be along z"),
    ("plane_misses_body", 10, "geometry.shape", "does not reach the plane z = 0.5 m"),
    ("missing_label_map", 5, "geometry.shape.label_map.file", "no_such_slice.nrrd: the file cannot be read"),
    ("unknown_label", 5, "geometry.shape.label_map.labels[2]", "label 7 does not occur; the map has [1, 2, 3]"),
    ("label_without_map", 20, "prescribe[0].where.label", "needs a `file`"),
    ("fine_spacing", 15, "discretisation.spacing", "about 1.000e18 nodes would be needed; the limit is 2e7: use a larger spacing"),
    ("endless_lattice", 28, "probe[0].lattice.counts", "asks for 73786976294838210000 positions; at most 1000000 are allowed"),
    ("late_time", 28, "output.times[1]", "is 0.2; it must be larger than 0.02 and at most 0.1"),
    ("times_of_a_static_run", 27, "output.times", "belongs to method = \"dynamic\""),
    ("times_and_frames", 29, "output.times", "takes the place of output.frames"),
    ("nothing_in_common", 5, "geometry.shape", "have nothing in common"),
    ("endless_history", 27, "output.history", "asks for 4000000000000 samples"),
    ("far_node", 15, "discretisation.file", "point 17: node 16 at (0.05, 1e160, 0.05) m lies far outside the body"),
    ("flat_nodes", 15, "discretisation.file", "has all nodes at z = 0 m; in 3d they need x, y and z"),
    ("millimetres_as_metres", 15, "discretisation.spacing", "use a larger spacing; is the `unit` of its file (\"m\" or \"mm\") right?"),
    ("missing_surface", 5, "geometry.shape.stl.file", "no_such.stl: the file cannot be read"),
];

fn folder() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/bad_cases"))
}

fn mistakes(path: &Path) -> Vec<Diagnostic> {
    match read_case(path) {
        Ok(_) => panic!("{} is accepted", path.display()),
        Err(mistakes) => mistakes,
    }
}

fn printed(mistakes: &[Diagnostic]) -> String {
    mistakes.iter().map(|mistake| format!("{mistake}\n")).collect()
}

#[test]
fn every_mistake_is_found_at_its_place() {
    let mut wrong = String::new();
    for (name, line, key, fragment) in BAD_CASES {
        let path = folder().join(format!("{name}.toml"));
        let found = mistakes(&path);
        let first = &found[0];
        let right = first.location.line == *line
            && first.location.file == path.display().to_string()
            && first.key == *key
            && first.message.contains(fragment);
        if !right {
            wrong += &format!("expected {line}: {key}: {fragment}\n{}\n", printed(&found));
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn a_mistake_is_reported_once() {
    for (name, ..) in BAD_CASES {
        let found = mistakes(&folder().join(format!("{name}.toml")));
        assert_eq!(found.len(), 1, "{name}:\n{}", printed(&found));
    }
}

#[test]
fn every_bad_case_is_in_the_table() {
    for entry in std::fs::read_dir(folder()).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_stem().unwrap().to_string_lossy().to_string();
        assert!(BAD_CASES.iter().any(|row| row.0 == name), "{name} is not tested");
    }
}

#[test]
fn a_mistake_is_printed_with_its_line_and_a_caret() {
    let found = mistakes(&folder().join("incompressible.toml"));
    let printed = found[0].to_string();
    let lines: Vec<&str> = printed.lines().collect();
    assert!(lines[0].ends_with(
        "incompressible.toml:11:17: material.tissue.poisson_ratio: is 0.5; it must lie in \
         -1 < ν < 0.5 (0.499 for nearly incompressible tissue)"
    ));
    assert_eq!(lines[1..], ["11 | poisson_ratio = 0.5", "   |                 ^^^"]);
}

#[test]
fn several_mistakes_are_reported_together() {
    let text = std::fs::read_to_string(folder().join("negative_density.toml")).unwrap();
    let text = text.replace("spacing = 0.02", "spacing = 0.02\ndilation = 0.5");
    let found = mtled_case::scene::parse_case(&text, "two.toml", &folder()).unwrap_err();
    let keys: Vec<&str> = found.iter().map(|mistake| mistake.key.as_str()).collect();
    assert_eq!(keys, ["material.tissue.density", "discretisation.dilation"]);
}

#[test]
fn of_many_numbers_that_are_not_finite_the_first_are_reported_and_the_others_counted() {
    let text = std::fs::read_to_string(folder().join("negative_density.toml")).unwrap();
    let rows = "nan, ".repeat(50_000);
    let text = format!("{text}[output]\nmoment_about = [{rows}]\n");
    let found = mtled_case::scene::parse_case(&text, "many.toml", &folder()).unwrap_err();
    assert_eq!(found.len(), 20);
    assert!(found[19].message.ends_with("so must 49980 more numbers of the file"), "{}", found[19]);
    let printed = found[19].to_string();
    let lines: Vec<&str> = printed.lines().collect();
    assert!(lines[1].len() < 200 && lines[2].len() < 200, "{printed}");
    let caret = lines[2].find('^').unwrap();
    assert_eq!(&lines[1][caret..caret + 3], "nan");
}

#[test]
fn a_case_file_that_does_not_end_is_refused() {
    let found = mistakes(Path::new("/dev/zero"));
    assert!(found[0].to_string().starts_with("/dev/zero: cannot be read: it has more than"));
}

#[cfg(unix)]
#[test]
fn a_named_pipe_is_refused_without_waiting_for_a_writer() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("case.toml");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let found = mistakes(&pipe);
    assert!(found[0].to_string().contains("it is a named pipe"), "{}", found[0]);
}

#[test]
fn a_case_file_that_does_not_exist_is_named() {
    let found = mistakes(Path::new("no/such/case.toml"));
    assert!(found[0].to_string().starts_with("no/such/case.toml: cannot be read: "));
}

/// A case in a folder of its own whose body is the label map `labels.nrrd`.
fn case_with_label_map(bytes: &[u8]) -> Vec<Diagnostic> {
    let text = std::fs::read_to_string(folder().join("missing_label_map.toml")).unwrap();
    let text = text.replace("../../../reference/brain/no_such_slice.nrrd", "labels.nrrd");
    let temporary = tempfile::tempdir().unwrap();
    std::fs::write(temporary.path().join("labels.nrrd"), bytes).unwrap();
    let case = temporary.path().join("case.toml");
    std::fs::write(&case, text).unwrap();
    mistakes(&case)
}

fn one_label_map_mistake(found: &[Diagnostic], fragment: &str) {
    let (count, first) = (found.len(), &found[0]);
    assert_eq!((count, first.location.line), (1, 5), "{}", printed(found));
    assert_eq!(first.key, "geometry.shape.label_map.file");
    assert!(first.message.contains(fragment), "{first}");
}

#[test]
fn a_truncated_label_map_is_refused_with_its_length() {
    let slice = folder().join("../../../reference/brain/slice.nrrd");
    let bytes = std::fs::read(slice).unwrap();
    let found = case_with_label_map(&bytes[..bytes.len() / 2]);
    one_label_map_mistake(&found, "truncated: its header states 149150 bytes of data, there are");
}

#[test]
fn the_labels_of_a_map_of_the_wrong_byte_order_do_not_occur() {
    let header = "NRRD0004\ntype: uint16\ndimension: 3\nsizes: 4 4 4\nencoding: raw\n\
                  endian: big\nspace directions: (10,0,0) (0,10,0) (0,0,10)\n\n";
    let mut bytes = header.as_bytes().to_vec();
    (0..64u16).for_each(|voxel| bytes.extend((voxel % 4).to_le_bytes()));
    let found = case_with_label_map(&bytes);
    let first = &found[0].message;
    assert!(first.contains("label 1 does not occur; the map has [256, 512, 768]"), "{first}");
    assert!(first.contains("the byte order of its header is wrong"), "{first}");
}

#[test]
fn a_label_map_that_is_something_else_is_refused() {
    let found = case_with_label_map(b"P5 157 190 255 ");
    one_label_map_mistake(&found, "this is not an NRRD file");
}
