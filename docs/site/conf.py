"""Settings of Sphinx for the site of the documentation."""

from __future__ import annotations

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parents[1])]

import doseki  # noqa: E402

project = "doseki"
author = "doseki developers"
copyright = "doseki developers"  # noqa: A001 (Sphinx reads it by this name)
release = version = doseki.__version__
language = "en_GB"

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "docs.site.mathml",
    "docs.site.math_font",
    "docs.site.equation_links",
    "docs.site.languages",
]
root_doc = "index"
exclude_patterns: list[str] = []
suppress_warnings = [
    "myst.header",  # pages may go from a title to a smaller heading
    "ref.python",  # a class has the name that it is imported by and that of its module
]
default_role = "code"
highlight_language = "none"
nitpicky = False

myst_enable_extensions = ["dollarmath", "attrs_inline", "deflist"]
myst_heading_anchors = 4
myst_dmath_double_inline = True
html_math_renderer = "mathml"

autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_class_signature = "separated"
python_use_unqualified_type_names = True
add_module_names = False

html_theme = "furo"
html_title = "doseki"
html_static_path = [str(HERE / "static")]
html_css_files = ["style.css"]
html_copy_source = False
html_show_sourcelink = False
html_show_sphinx = False
html_theme_options = {"sidebar_hide_name": False, "navigation_with_keys": True}
pygments_style, pygments_dark_style = "friendly", "monokai"
