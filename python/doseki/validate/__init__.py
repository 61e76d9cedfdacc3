"""Validation: cases run as a user would run them, against formulas and measurements.

case.py says what a case is, running.py advances its scenario, estimators.py turns states into
numbers, judging.py into verdicts, report.py and picture.py into what is read.  The cases lie in
cases/, each a module beside its scenario, so that an installed doseki has them as well as a tree.
"""
