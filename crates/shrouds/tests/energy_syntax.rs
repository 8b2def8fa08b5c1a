//! Energies as text.

#![allow(clippy::unwrap_used)]

use shrouds::Error;
use shrouds::energy::{Bending, CurveFormula, Energy, Parameter, Point2, Scalar, catalogue};

/// Names and weights.
fn parts(energy: &Energy) -> Vec<(String, f64)> {
    energy.parts().iter().map(|part| (part.measure.name(), part.weight)).collect()
}

fn parsed(text: &str) -> Vec<(String, f64)> {
    parts(&text.parse().unwrap_or_else(|e| panic!("{e}")))
}

#[test]
fn sums_with_weights_and_white_space_are_read() {
    let expected = vec![("bending".into(), 1.0), ("variation".into(), 0.3)];
    for text in
        ["bending+0.3*variation", " bending +\t0.3 * variation ", "1*bending+3e-1*variation"]
    {
        assert_eq!(parsed(text), expected, "{text}");
    }
    assert_eq!(
        parsed("2e+2*bending+1.*linear"),
        [("bending".into(), 200.0), ("linear(uniform)".into(), 1.0)]
    );
    assert_eq!(parsed("0*bending"), [("bending".into(), 0.0)]);
    assert_eq!(parsed("curvature ( centripetal )"), parsed("curvature(centripetal)"));
    assert_eq!(parsed("curvature"), parsed("curvature(chord)"));
    let tight = "2*linear(chord)+1*stretch(chord)";
    assert_eq!(parsed("2*tension(0.5, chord)"), parsed(tight));
    assert_eq!(parsed("angle"), parsed("angle(squared)"));
}

#[test]
fn what_is_written_reads_back_the_same() {
    let mut texts: Vec<String> = catalogue().iter().map(|entry| entry.name.into()).collect();
    for entry in catalogue().iter().filter(|entry| entry.arguments.starts_with("[parameter")) {
        texts.extend(Parameter::ALL.map(|p| format!("0.1*{}({p})+1e-9*bending", entry.name)));
    }
    texts.extend(
        ["tension(0.25)", "tension(2, chord)", "angle(cosine)", "3*tension"].map(String::from),
    );
    texts.push("3e300*bending+1e-300*linear(chord)".into());
    for text in texts {
        let energy: Energy = text.parse().unwrap_or_else(|e| panic!("{e}"));
        let again: Energy = energy.to_string().parse().unwrap();
        assert_eq!(parts(&again), parts(&energy), "{text}");
    }
}

#[test]
fn a_text_that_is_no_energy_is_told_what_there_is() {
    let wrong = [
        ("", "a measure is missing"),
        ("bending+", "a measure is missing"),
        ("+bending", "\"+\" is not a number from 0 up"),
        ("bend", "no measure named \"bend\""),
        ("Bending", "no measure named \"Bending\""),
        ("custom", "no measure named"),
        ("-1*bending", "not a number from 0 up"),
        ("1e999*bending", "not a number from 0 up"),
        ("0.3.1*bending", "not a number from 0 up"),
        ("0.3 bending", "after the weight"),
        ("0.3", "after the weight"),
        ("bending variation", "was not expected"),
        ("bending*2", "was not expected"),
        ("bending(chord)", "takes no arguments"),
        ("linear(chord", "closing parenthesis"),
        ("linear()", "no parametrisation \"\""),
        ("linear(länge)", "no parametrisation \"länge\""),
        ("linear(chord,chord)", "one argument too many"),
        ("tension(chord)", "not a number from 0 up"),
        ("tension(-1)", "not a number from 0 up"),
        ("tension(1,chord,2)", "one argument too many"),
        ("angle(round)", "neither squared nor cosine"),
        ("δ", "a measure is missing"),
    ];
    for (text, reason) in wrong {
        let error = text.parse::<Energy>().unwrap_err();
        let message = error.to_string();
        assert!(matches!(error, Error::Energy { .. }) && message.contains(reason), "{message}");
        for entry in catalogue() {
            assert!(message.contains(entry.name), "{message} does not name {}", entry.name);
        }
    }
}

#[test]
fn a_measure_of_ones_own_is_called_custom() {
    struct Mine;
    impl CurveFormula for Mine {
        fn residual<S: Scalar>(&self, points: [Point2<S>; 4]) -> [S; 2] {
            points[0]
        }
    }
    let energy = Energy::from(Bending) + 2.0 * Energy::from(Mine);
    assert_eq!(energy.to_string(), "bending+2*custom");
    assert_eq!(format!("{energy:?}"), "Energy(bending+2*custom)");
}
