"""Templates of Markdown pages: an undefined name is an error, and a line with a statement only leaves no trace."""

from __future__ import annotations

import jinja2

from ..project.wording import in_markdown


def templates(loader: jinja2.BaseLoader | None = None) -> jinja2.Environment:
    """The templates of this room, or those of another loader, with the filter for text of a user."""
    environment = jinja2.Environment(
        loader=loader or jinja2.PackageLoader("dampbalance.publishing"),
        autoescape=False,  # Markdown, from files of the project and numbers only
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters["in_markdown"] = in_markdown
    return environment
