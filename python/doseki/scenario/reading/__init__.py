"""Reading a scenario: shipped files, `extends`, --set, expressions, error messages."""
