"""The command line; see ``multirep --help``.

Nothing heavy is imported here: each command imports what it needs when it runs, so ``--help``
answers at once.
"""

from __future__ import annotations

import shutil
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

import click

from multirep import __version__
from multirep.errors import ConflictError, MissingExtraError, MultirepError, ScriptError

if TYPE_CHECKING:
    from multirep.script.running import Result

__all__ = ["main"]

EPILOG = "Exit codes: 0 done; 1 the work failed; 2 the input is wrong; 130 interrupted."
#: What a shell gives for a process that Ctrl-C ended.
INTERRUPTED = 130


class _Commands(click.Group):
    """Commands in the order in which one meets them; errors as one sentence and an exit code."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(self.commands)

    def invoke(self, ctx: click.Context) -> Any:
        try:
            return super().invoke(ctx)
        except MultirepError as error:
            _fail(error)
        except KeyboardInterrupt:
            click.echo("multirep: interrupted; no file was left half-written", err=True)
            raise SystemExit(INTERRUPTED) from None


def _fail(error: MultirepError) -> NoReturn:
    """Print an error and leave: 1 when the work failed, 2 when the input is wrong."""
    click.echo(f"multirep: {error}", err=True)
    if isinstance(error.__cause__, ConflictError):
        from multirep.conflicts import details

        for line in details(error.__cause__):
            click.echo(f"  {line}", err=True)
    wrong = isinstance(error, ScriptError | MissingExtraError)
    raise SystemExit(2 if wrong else 1)


@click.group(
    cls=_Commands,
    epilog=EPILOG,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
)
@click.version_option(__version__, prog_name="multirep", message="%(prog)s %(version)s")
def main() -> None:
    """One curve as polyline, NURBS and wavelet B-spline at once, kept within a proved tolerance."""


def _tolerance(ctx: click.Context, option: click.Parameter, value: float | None) -> float | None:
    """Refuse what is no tolerance (click lets NaN and infinity through)."""
    if value is not None and not 0 < value < float("inf"):
        raise click.BadParameter(f"expected a positive number, got {value!r}")
    return value


SCRIPT = click.argument("script", type=click.Path(path_type=Path), metavar="SCRIPT")
TOLERANCE = click.option(
    "--tolerance",
    type=float,
    callback=_tolerance,
    metavar="E",
    help="Use this tolerance for every curve instead of the script's.",
)


@main.command()
@SCRIPT
@click.option(
    "--out",
    type=click.Path(path_type=Path, file_okay=False),
    metavar="DIR",
    help="Where to write (default: the script's name with -out, in the working directory).",
)
@TOLERANCE
def run(script: Path, out: Path | None, tolerance: float | None) -> None:
    """Run a script; write its pictures, report.json and geometry.json.

    Everything is written when all of the work is done, or nothing is.
    """
    from multirep.drawing.svg import to_svg
    from multirep.script.files import write_all
    from multirep.script.pictures import picture
    from multirep.script.report import geometry, report, to_json

    result = _run(script, tolerance)
    files: dict[str, str | bytes] = {
        output.svg: to_svg(picture(result, output)) for output in result.script.outputs
    }
    files["report.json"] = to_json(report(result), indent=1)
    files["geometry.json"] = to_json(geometry(result))
    written = write_all(out if out is not None else Path(f"{script.stem}-out"), files)
    _describe(result)
    click.echo("wrote " + ", ".join(map(str, written)))


@main.command()
@click.argument("file", type=click.Path(path_type=Path), metavar="FILE")
@TOLERANCE
def check(file: Path, tolerance: float | None) -> None:
    """Print the certified deviation of every pair of representations after running a script.

    Exit code 1 when one exceeds the tolerance of its curve.
    """
    result = _run(file, tolerance)
    _describe(result)
    exceeded = [
        f"{curve.name}: {'~'.join(pair)}"
        for curve in result.curves
        for pair, deviation in curve.deviations.items()
        if not deviation.upper <= curve.tolerance
    ]
    if exceeded:
        click.echo("exceeds the tolerance: " + "; ".join(exceeded), err=True)
        raise SystemExit(1)


@main.command()
@click.argument("file", type=click.Path(path_type=Path), metavar="FILE")
@click.option(
    "-o",
    "--output",
    required=True,
    type=click.Path(path_type=Path, dir_okay=False),
    metavar="PICTURE",
    help="A name that ends in .svg or .png (PNG needs the extra 'plot').",
)
@TOLERANCE
def render(file: Path, output: Path, tolerance: float | None) -> None:
    """Run a script and draw all its curves in all their representations."""
    if output.suffix.lower() not in (".svg", ".png"):
        raise click.BadParameter(
            f"expected a name that ends in .svg or .png, got {str(output)!r}", param_hint="--output"
        )
    from multirep.drawing.svg import to_svg
    from multirep.script.files import write_all
    from multirep.script.model import Output
    from multirep.script.pictures import picture

    result = _run(file, tolerance)
    first = next(iter(result.script.outputs), Output(""))
    drawn = picture(result, Output("", title=first.title, y=first.y))
    content: str | bytes
    if output.suffix.lower() == ".svg":
        content = to_svg(drawn)
    else:
        from multirep.drawing.png import to_png

        content = to_png(drawn)
    write_all(output.parent, {output.name: content})
    click.echo(f"wrote {output}")


@main.command()
def plugins() -> None:
    """List representations, tools and constraints.

    Says what each needs, which parameters it takes and where it comes from.

    Exit code 1 when one of them cannot be loaded.
    """
    from multirep.listing import list_plugins
    from multirep.registry import Registry

    text, broken = list_plugins(Registry.discover())
    click.echo(text)
    if broken:
        raise SystemExit(1)


def _run(path: Path, tolerance: float | None) -> Result:
    """Read and run a script, with progress on a terminal."""
    import numpy as np

    from multirep.registry import Registry
    from multirep.script.reading import read_script
    from multirep.script.running import run as run_script

    registry = Registry.discover()
    script = read_script(path, registry, tolerance=tolerance)
    progress, done = _progress()
    try:
        # Numbers that overflow are found by the checks, which say more than numpy's warnings.
        with np.errstate(all="ignore"):
            return run_script(script, registry, progress)
    finally:
        done()


def _progress() -> tuple[Callable[[int, int, str], None] | None, Callable[[], None]]:
    """Return what tells of progress and what wipes it off; silent unless stderr is a terminal."""
    if not sys.stderr.isatty():
        return None, lambda: None

    def tell(done: int, total: int, what: str) -> None:
        line = f"{done + 1}/{total} {what}"
        width = shutil.get_terminal_size().columns - 1  # a line that wraps could not be wiped off
        click.echo(f"\r\x1b[K{line[:width]}", nl=False, err=True)

    return tell, lambda: click.echo("\r\x1b[K", nl=False, err=True)


def _describe(result: Result) -> None:
    """Print sizes and deviations."""
    for curve in result.curves:
        sizes = ", ".join(f"{kind} {value.size}" for kind, value in curve.representations.items())
        click.echo(f"{curve.name}: tolerance {curve.tolerance:g}; {sizes}")
        for pair, deviation in curve.deviations.items():
            click.echo(
                f"  {'~'.join(pair):20s} seen {deviation.lower:<12.6g} "
                f"proved <= {deviation.upper:.6g}"
            )
        for note in curve.notes:
            click.echo(f"  note: {note}")
