"""A certificate of the service's own, made at its first start by the program openssl, and its fingerprint."""

from __future__ import annotations

import hashlib
import os
import re
import socket
import ssl
import subprocess
import tempfile
from ipaddress import ip_address
from pathlib import Path

from robophm.core.errors import RobophmError

DAYS = 3650
"""Days for which a certificate of one's own holds: nobody renews it on a robot."""


def own_certificate(path: Path, host: str) -> Path:
    """Return the file with a key and its self-signed certificate, made where there is none. Raises RobophmError."""
    if path.exists():
        return path
    names = [_alternative(one) for one in dict.fromkeys((host, socket.gethostname(), "localhost", "127.0.0.1")) if one]
    made = Path(tempfile.mkdtemp(dir=path.parent, prefix=".robophm.")) / "key.pem"
    command = ["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes",
               "-days", str(DAYS), "-subj", "/CN=robophm", "-addext", f"subjectAltName={','.join(names)}",
               "-addext", "extendedKeyUsage=serverAuth", "-keyout", str(made), "-out", "-"]  # fmt: skip
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=True)
        text = made.read_text(encoding="ascii") + done.stdout
        with os.fdopen(os.open(made.with_name("both.pem"), os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o600), "w") as both:
            both.write(text)
        made.with_name("both.pem").replace(path)
    except (OSError, subprocess.SubprocessError) as error:
        raise RobophmError(
            f"{path}: no certificate can be made: {getattr(error, 'stderr', None) or error}; expected the program "
            "openssl, or a certificate of your own"
        ) from None
    finally:
        for left in (made, made.with_name("both.pem")):
            left.unlink(missing_ok=True)
        made.parent.rmdir()
    return path


def tls_context(certificate: Path, key: Path | None) -> ssl.SSLContext:
    """Return what a server needs for TLS 1.2 and later. Raises RobophmError where these are no certificate and key."""
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.minimum_version = ssl.TLSVersion.TLSv1_2
    try:
        context.load_cert_chain(certificate, key, password=lambda: "")
    except (OSError, ssl.SSLError, ValueError) as error:
        which = f"{certificate}{f' and {key}' if key else ''}"
        raise RobophmError(f"{which}: {error}; expected a certificate and its key in PEM") from None
    return context


def fingerprint(certificate: Path) -> str:
    """Return the SHA-256 fingerprint of the first certificate in a file, as browsers show it."""
    found = re.search(r"-----BEGIN CERTIFICATE-----.*?-----END CERTIFICATE-----", certificate.read_text("ascii"), re.S)
    digest = hashlib.sha256(ssl.PEM_cert_to_DER_cert(found[0] if found else "")).hexdigest().upper()
    return ":".join(digest[i : i + 2] for i in range(0, len(digest), 2))


def _alternative(name: str) -> str:
    try:
        return f"IP:{ip_address(name)}"
    except ValueError:
        return f"DNS:{re.sub(r'[^A-Za-z0-9.-]', '', name)}"
