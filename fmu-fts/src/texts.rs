//! Texts among the parameters, and the tables that they name; the law gets what is read from them.

use std::path::Path;

use control_blocks::ParameterError;
use serde::{Deserialize, Serialize};

use crate::controller::Tables;
use crate::parameters::{Parameters, SurfaceKind};
use crate::{path_file, response_file};

/// Texts among the parameters.
#[derive(Clone, Serialize, Deserialize)]
pub struct Texts {
    /// Of the path.
    pub path: TextPath,
    /// Of the frequency response.
    pub response: TextResponse,
    /// Of the cancellation.
    pub afc: TextAfc,
    /// Of the measurement of the frequency response.
    pub identify: TextIdentify,
}

/// Texts of the path.
#[derive(Clone, Serialize, Deserialize)]
pub struct TextPath {
    /// JSON table, in the folder `resources` of the FMU or with its whole path.
    pub file: String,
}

/// Texts of the frequency response.
#[derive(Clone, Serialize, Deserialize)]
pub struct TextResponse {
    /// JSON table, in the folder `resources` of the FMU or with its whole path.
    pub file: String,
}

/// Texts of the cancellation.
#[derive(Clone, Serialize, Deserialize)]
pub struct TextAfc {
    /// List of harmonics.
    pub harmonics: String,
}

/// Texts of the measurement of the frequency response.
#[derive(Clone, Serialize, Deserialize)]
pub struct TextIdentify {
    /// List of frequencies, Hz.
    pub frequencies: String,
}

impl Texts {
    /// All empty; the start values are in the variable table of the FMU.
    pub const EMPTY: Self = Self {
        path: TextPath { file: String::new() },
        response: TextResponse { file: String::new() },
        afc: TextAfc { harmonics: String::new() },
        identify: TextIdentify { frequencies: String::new() },
    };

    /// The tables from the files that the texts name.
    ///
    /// # Errors
    /// Names the file, the field, its value and the limit.
    pub fn tables(&self, p: &Parameters, resources: Option<&Path>) -> Result<Tables, ParameterError> {
        let response = &self.response.file;
        Ok(Tables {
            depth: match p.surface.kind {
                SurfaceKind::File => Some(path_file::read(&self.path.file, resources, p)?),
                SurfaceKind::Toric | SurfaceKind::Wave => None,
            },
            response: (!response.is_empty()).then(|| response_file::read(response, resources)).transpose()?,
        })
    }
}
