//! `export!`: makes the tables of a model and the C functions that are compiled for this model.

/// Exports a [`Model`](crate::Model) from this library as an FMI 2.0 FMU, for co-simulation and model exchange.
///
/// One library holds one model. What breaks a rule of the declaration or of the facts does not compile.
///
/// The functions made here are those that are called in every step, and those that must know the model; all others are
/// in [`c_api`](crate::c_api).
#[macro_export]
macro_rules! export {
    ($model:ty) => {
        const _: () = {
            use $crate::c_api as api;
            type Vars = <$model as $crate::Model>::Vars;
            const TABLE: &[$crate::Variable<Vars>] = <Vars as $crate::Interface>::TABLE;
            const _: () = $crate::__private::check::<$model>();
            const SHORT: &[$crate::Variable<Vars>; TABLE.len()] = &$crate::__private::without_texts(TABLE);
            const ROWS: &[$crate::Variable<Vars>] = if $crate::__private::HAS_FILES { TABLE } else { SHORT };
            const COUNT: (usize, usize) = $crate::__private::count(TABLE);
            const ENTRIES: &[$crate::__private::Entry<Vars>; COUNT.0] = &$crate::__private::entries(ROWS);
            const COMPUTED: &[$crate::__private::Entry<Vars>; COUNT.1] = &$crate::__private::computed(ENTRIES);
            const RUNS: &([$crate::__private::Run<Vars>; COUNT.1], usize) = &$crate::__private::runs(COMPUTED);
            static FILES: $crate::__private::Files = $crate::__private::Files::new();

            impl $crate::__private::Exported for $model {
                const INDEX: $crate::__private::Index<Vars> =
                    $crate::__private::Index::new(ENTRIES, COMPUTED, RUNS.0.split_at(RUNS.1).0);
                const GUID: [u8; 36] = $crate::__private::guid::<$model>();
            }

            /// The GUID of the model description, for tools that read it without running the library.
            #[unsafe(no_mangle)]
            #[allow(non_upper_case_globals)]
            pub static fmi2_export_guid: [u8; 36] = <$model as $crate::__private::Exported>::GUID;

            #[unsafe(no_mangle)]
            unsafe extern "C" fn fmi2Instantiate(
                name: api::fmi2String,
                kind: api::fmi2Type,
                guid: api::fmi2String,
                resources: api::fmi2String,
                functions: *const api::fmi2CallbackFunctions,
                visible: api::fmi2Boolean,
                logging: api::fmi2Boolean,
            ) -> api::fmi2Component {
                // SAFETY: the caller keeps the promises of the standard.
                unsafe { api::instantiate::<$model>(name, kind, guid, resources, functions, visible, logging) }
            }

            #[unsafe(no_mangle)]
            unsafe extern "C" fn fmi2SetReal(
                c: api::fmi2Component,
                references: *const api::fmi2ValueReference,
                count: usize,
                values: *const api::fmi2Real,
            ) -> api::fmi2Status {
                // SAFETY: as above, and every instance of this library is one of this model.
                unsafe { api::set_real::<$model>(c, references, count, values) }
            }

            #[unsafe(no_mangle)]
            unsafe extern "C" fn fmi2GetReal(
                c: api::fmi2Component,
                references: *const api::fmi2ValueReference,
                count: usize,
                values: *mut api::fmi2Real,
            ) -> api::fmi2Status {
                // SAFETY: as above.
                unsafe { api::get_real::<$model>(c, references, count, values) }
            }

            #[unsafe(no_mangle)]
            unsafe extern "C" fn fmi2DoStep(
                c: api::fmi2Component,
                time: api::fmi2Real,
                step: api::fmi2Real,
                no_set_state_prior: api::fmi2Boolean,
            ) -> api::fmi2Status {
                // SAFETY: as above.
                unsafe { api::do_step::<$model>(c, time, step, no_set_state_prior) }
            }

            /// A generated file of the FMU: `modelDescription.xml` or `documentation/index.html`; an empty path lists
            /// them, one per line. NULL for any other path. Not part of FMI: packers read it.
            #[unsafe(no_mangle)]
            unsafe extern "C" fn fmi2_export_file(path: api::fmi2String) -> api::fmi2String {
                // SAFETY: the caller gives a C string or NULL.
                unsafe { api::file::<$model>(&FILES, path) }
            }

            const _: api::Instantiate = fmi2Instantiate;
            const _: api::SetReal = fmi2SetReal;
            const _: api::GetReal = fmi2GetReal;
            const _: api::DoStep = fmi2DoStep;
        };
    };
}
