//! The overview in a plan: what pictures of all steps have in common, found once and handed to the parts.

use std::path::Path;

use anyhow::{Context, bail, ensure};
use photosurface::jobs::Overview;
use photosurface::read::read_whole;
use photosurface::write::Fingerprint;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// The largest plan that is read: that of a million files.
const MAX_BYTES: u64 = 1 << 28;

/// An overview, and of what it is.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
pub(super) struct PlannedOverview {
    /// Of the version, the scene, all files that are read, and all flags on which pictures depend.
    fingerprint: String,
    /// Of the fingerprint and of what was found, so that no damage goes unnoticed.
    digest: String,
    /// What was found by looking at all steps.
    #[schemars(with = "Value")]
    found: Overview,
}

impl PlannedOverview {
    /// What was found of pictures with this fingerprint.
    pub(super) fn new(found: Overview, fingerprint: Fingerprint) -> Self {
        Self {
            fingerprint: fingerprint.to_string(),
            digest: digest(&found, fingerprint),
            found,
        }
    }

    /// The overview in a plan of pictures with this fingerprint.
    pub(super) fn read(path: &Path, fingerprint: Fingerprint) -> anyhow::Result<Overview> {
        let bytes = read_whole(path, MAX_BYTES)?;
        overview(&bytes, fingerprint).with_context(|| path.display().to_string())
    }
}

fn overview(bytes: &[u8], fingerprint: Fingerprint) -> anyhow::Result<Overview> {
    const EXPECTED: &str = "expected what render --plan prints";
    let plan: Value = match serde_json::from_slice(bytes) {
        Ok(plan) => plan,
        Err(error) => bail!("is no plan: {error}; {EXPECTED}"),
    };
    let own = env!("CARGO_PKG_VERSION");
    let Some(version) = plan["version"].as_str() else {
        bail!("is no plan: there is no \"version\"; {EXPECTED}");
    };
    ensure!(
        version == own,
        "is a plan of version {version}, expected one of {own}; make it anew with --plan"
    );
    let planned = &plan["overview"];
    ensure!(
        !planned.is_null(),
        "is a plan without \"overview\"; expected that of render, made with --plan and not with --plan=files"
    );
    let planned: PlannedOverview = match serde_json::from_value(planned.clone()) {
        Ok(planned) => planned,
        Err(error) => bail!("is damaged: \"overview\": {error}; make it anew with --plan"),
    };
    ensure!(
        planned.fingerprint == fingerprint.to_string(),
        "is the plan of another scene, of other files or of other flags; make it anew with --plan and the flags of the parts"
    );
    ensure!(
        planned.digest == digest(&planned.found, fingerprint),
        "is damaged: \"overview\" is not as it was found; make it anew with --plan"
    );
    Ok(planned.found)
}

fn digest(found: &Overview, fingerprint: Fingerprint) -> String {
    fingerprint.with("overview", found).to_string()
}
