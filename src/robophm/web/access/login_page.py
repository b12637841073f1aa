"""The page on which people log in, which loads nothing and needs no JavaScript."""

from __future__ import annotations

PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>robophm: log in</title></head>
<body><main><h1>Log in</h1>
{words}<form action="./login" method="post">
<p><label>Name <input name="name" required autocomplete="username" autofocus></label></p>
<p><label>Password <input type="password" name="password" required autocomplete="current-password"></label></p>
<p><button>Log in</button></p></form>
<p><small>Users are added on the robot: <code>robophm users add</code></small></p></main></body></html>
"""

HEADERS = {"cache-control": "no-store", "referrer-policy": "same-origin"}
"""Headers of the page: without a referrer its form would be of no origin, and be refused."""


def login_page(words: str = "") -> str:
    """Return the page, with words (HTML) of why it is shown again."""
    return PAGE.replace("{words}", f'<p role="alert">{words}</p>\n' if words else "")
