//! Contents of the text parameters: lists of numbers, and tables in files.

pub mod json_table;

use std::path::Path;

use control_blocks::ParameterError;

use crate::interface::{Parameters, SurfaceKind};
use crate::path::depth_table::DepthTable;
use crate::path::path_file;
use crate::servo::response::FrequencyResponse;
use crate::servo::response_file;

/// Tables that come from files; none by default.
#[derive(Clone, Debug, Default)]
pub struct Tables {
    /// Depth of the path, for `surface.kind` = File.
    pub(crate) depth: Option<DepthTable>,
    /// Measured response of the position loop.
    pub(crate) response: Option<FrequencyResponse>,
}

impl Tables {
    /// The tables from the files that the parameters name.
    ///
    /// # Errors
    /// Names the file, the field, its value and the limit.
    pub fn read(p: &Parameters, resources: Option<&Path>) -> Result<Self, ParameterError> {
        let response = &p.response_file;
        Ok(Self {
            depth: match p.surface.kind {
                SurfaceKind::File => Some(path_file::read(&p.path.file, resources, p)?),
                SurfaceKind::Toric | SurfaceKind::Wave => None,
            },
            response: (!response.is_empty()).then(|| response_file::read(response, resources)).transpose()?,
        })
    }
}

impl Parameters {
    /// Reads the lists of harmonics and of frequencies.
    ///
    /// # Errors
    /// Names the list, its text and what cannot be read.
    pub fn read_lists(&mut self) -> Result<(), ParameterError> {
        self.afc.cancelled = self.afc.harmonics.parse()?;
        self.identify.grid = self.identify.frequencies.parse()?;
        Ok(())
    }
}
