//! A wrong declaration does not compile, and the error names the field and the rule, at its line.

#[test]
fn a_wrong_declaration_does_not_compile() {
    trybuild::TestCases::new().compile_fail("tests/declaration/*.rs");
}
