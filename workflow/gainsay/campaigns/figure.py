"""The figure of a campaign, from its gathered table."""

import io

from gainsay.campaigns.plan import Plan
from gainsay.campaigns.store import folder, gathered
from gainsay.tables.files import write_atomically

_HEIGHT = 3.6


def draw(plan: Plan) -> None:
    """Draw the figure of a campaign as SVG, the same to the byte on one machine."""
    import matplotlib
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    from gainsay.figures.style import STYLE, width_of

    columns = ["index", *(name for name in plan.evaluation.columns if name != "certificate")]
    with matplotlib.rc_context({**STYLE, "svg.fonttype": "path"}):
        figure = Figure(figsize=(width_of(plan.case), _HEIGHT), layout="constrained")
        plan.evaluation.draw(figure, plan, gathered(plan, columns))
        out = io.BytesIO()
        FigureCanvasSVG(figure).print_svg(out, metadata={"Date": None, "Creator": None})
    write_atomically(folder(plan) / f"{plan.row.name}.svg", out.getvalue())
