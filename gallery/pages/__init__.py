"""The pages of the gallery, in the order of its index: from a minute's work to the flume."""

from ..page import Page
from . import (
    dam_step,
    drip,
    drum,
    elastic_gate,
    flood_log,
    flume,
    mud_slump,
    segregation,
    slide_wave,
    slit_dam,
    valley,
    voellmy_chute,
)

PAGES: dict[str, Page] = {
    module.PAGE.scenario: module.PAGE
    for module in (
        drip,
        drum,
        dam_step,
        elastic_gate,
        segregation,
        voellmy_chute,
        mud_slump,
        flood_log,
        slide_wave,
        slit_dam,
        valley,
        flume,
    )
}
