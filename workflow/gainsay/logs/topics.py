"""What the logs of a paper hold, topic by topic, as a page of Markdown that is made with them."""

from gainsay.logs.reader import Log

_WHAT = {
    "signal": "samples",
    "shown": "samples in the unit of plots",
    "bound": "bound",
    "extreme": "located extremes, one message",
    "summary": "numbers known at the end, one message",
    "events": "text log",
    "transforms": "frames",
    "scene": "drawing",
}


class Topics:
    """Collects the topics of a paper's logs, run by run."""

    def __init__(self) -> None:
        self._runs: dict[str, str] = {}
        self._topics: dict[str, tuple[str, dict[str, str], list[str]]] = {}

    def add(self, run: str, log: Log) -> None:
        """Note what a log holds."""
        self._runs[run] = log.metadata.get("about", "")
        for topic in log.topics:
            units = log[topic].units if topic in log else {}
            _, known, runs = self._topics.setdefault(topic, (log.kind(topic), dict(units), []))
            known.update(units)
            runs.append(run)

    def page(self, paper: str) -> str:
        """Return the page: runs, then topics with their fields, units and, where not all, their runs."""
        lines = [f"# Logs of {paper}", "", "Made with the logs; how to read them stands in `docs/logs.md`.", ""]
        lines += ["| run | what it is |", "| --- | --- |"]
        lines += [f"| `{run}` | {_cell(about)} |" for run, about in self._runs.items()]
        lines += ["", "| topic | holds | fields | runs |", "| --- | --- | --- | --- |"]
        for topic, (kind, units, runs) in sorted(self._topics.items()):
            fields = ", ".join(f"`{field}` [{unit}]" for field, unit in units.items())
            where = "all" if len(runs) == len(self._runs) else ", ".join(f"`{run}`" for run in runs)
            lines.append(f"| `{topic}` | {_WHAT.get(kind, kind)} | {fields} | {where} |")
        return "\n".join(lines) + "\n"


def _cell(text: str) -> str:
    return text.replace("|", "\\|")
