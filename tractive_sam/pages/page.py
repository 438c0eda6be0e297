"""The frame that all pages share: head, style and security policy."""

from collections.abc import Sequence
from importlib.resources import files

from tractive_sam.markup import Content, Html, fill, security_policy


def fill_page(package: str, name: str, scripts: Sequence[str] = (), **content: Content) -> Html:
    """Return a page that needs no other file, from the body and the style sheet of a package.

    Parameters
    ----------
    package, name : str
        The package whose files "name.html", a template of the body, and "name.css" are used.
    scripts : sequence of str
        Scripts in the body that may run. With scripts, style attributes and empty style elements
        are allowed: plotly sets the attributes and fills the elements, and neither runs anything.
    **content : str or iterable of Html
        Content of the placeholders: the title, further elements of the head if there are any, and
        the placeholders of the body. See `fill`.
    """
    shared, own = files(__package__), files(package)
    sheets = shared.joinpath("style.css"), own.joinpath(f"{name}.css")
    style = Html("\n".join(["", *(sheet.read_text("utf-8") for sheet in sheets)]))
    policy = security_policy(scripts, [style, ""] if scripts else [style], bool(scripts))
    body = own.joinpath(f"{name}.html").read_text("utf-8")
    template = shared.joinpath("page.html").read_text("utf-8").replace("$body", body)
    return fill(template, **({"head": ""} | content), policy=policy, style=style)
