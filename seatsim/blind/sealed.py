"""The sealed file: labels and unseen runs, encrypted (Fernet: AES-128-CBC with HMAC-SHA256), opened by a key alone.

A label is written in words of its own: kinds of cases, the contract's effects, the blocks of a rig.
"""

import base64
import hashlib
import hmac
import io
import json
import zipfile
from pathlib import Path
from typing import Literal, NamedTuple, Required, TypedDict, get_args

from cryptography.fernet import Fernet, InvalidToken
from cryptography.hazmat.primitives.ciphers import Cipher
from cryptography.hazmat.primitives.ciphers.algorithms import AES
from cryptography.hazmat.primitives.ciphers.modes import CBC
from cryptography.hazmat.primitives.padding import PKCS7

from seatsim.schema.errors import InputError
from seatsim.schema.fields import read_packaged
from seatsim.schema.files import make_folder, write_bytes, write_text
from seatsim.schema.guarded import read_bytes
from seatsim.schema.text import explain_bad_name

Kind = Literal["none", "one", "two", "outside"]
KINDS: tuple[Kind, ...] = get_args(Kind)
"""No effect, one or two effects of the library, something outside the library."""
_CarriedKind = Literal["carried", "untouched"]
"""One effect on a measured recording, and such a recording as it was measured, of which nobody knows what is true."""
_LIBRARY = read_packaged(Path(__file__).with_name("library.yaml"), dict[str, list[str]])
EFFECTS = tuple(f"{block}.{name}" for block, names in _LIBRARY.items() for name in names)
"""The library of the contract, section 5, written again: the makers share no code with the candidates."""


class Label(TypedDict, total=False):
    """What is true of a case. Lists go in parallel, one entry for each fault; a hand-made label may hold less."""

    kind: Required[Kind | _CarriedKind]
    effects: Required[list[str]]
    """Effects of the library that are at work; empty outside it."""
    blocks: Required[list[str]]
    """Block of each fault."""
    forms: list[str]
    """Name of each fault scenario."""
    severities: list[float]
    materialities: list[float]
    """Of each fault beside the others; 1 is the material limit."""
    shapes: list[dict[str, float]]
    """Parameters of each fault; on a measured recording under the names that the effect's own parameters have."""
    faulty_channels: list[str]
    missing: list[str]
    """Channels that are not recorded."""
    background: float
    """Random force on the frame, N rms."""


_LARGEST = 2**30
"""Bytes of a sealed file."""
_LABELS = "labels.json"
"""Name of the labels inside the sealed file."""
SEAL = "seal.txt"
"""Name of the hash beside the recordings."""


class Sealed(NamedTuple):
    """What a sealed file holds: labels by case, unseen recordings by case (files by name), and what made them."""

    labels: dict[str, Label]
    unseen: dict[str, dict[str, bytes]]
    made: dict[str, object]
    """Seed, whether that was given or drawn, number and kinds of the cases."""

    def extract(self, case: str, folder: Path) -> Path:
        """Write the unseen recording of a case into `folder`/`case` and return that; empty where none was withheld."""
        out = folder / case
        make_folder(out)
        for name, content in self.unseen.get(case, {}).items():
            write_bytes(out / name, content)
        return out


def new_key() -> str:
    """Return a fresh key."""
    return Fernet.generate_key().decode()


def key_of(name: str) -> str:
    """Return the key of the public set with a name."""
    return base64.urlsafe_b64encode(hashlib.sha256(name.encode()).digest()).decode()


def seal(path: Path, folder: Path, key: str, content: Sealed) -> str:
    """Write the sealed file and its SHA-256 into `folder`/seal.txt; return the hash.

    The hash lies beside the recordings, so that labels cannot be exchanged for others after the diagnoses. The same key
    and content give the same bytes.

    Raises:
        InputError: a file cannot be written.
    """
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_STORED) as archive:
        archive.writestr(_entry(_LABELS), json.dumps({"made": content.made, "cases": content.labels}))
        for case, files in content.unseen.items():
            for name, data in files.items():
                archive.writestr(_entry(f"unseen/{case}/{name}"), data)
    token = _encrypt(key, packed.getvalue())
    write_bytes(path, token)
    digest = hashlib.sha256(token).hexdigest()
    write_text(folder / SEAL, f"sha256 {digest}\n")
    return digest


def _entry(name: str) -> zipfile.ZipInfo:
    """Return the head of a file of an archive without time and system."""
    head = zipfile.ZipInfo(name)
    head.create_system = 0
    return head


def _encrypt(key: str, content: bytes) -> bytes:
    """Return a Fernet token without time, whose initialisation vector follows from key and content."""
    secret = base64.urlsafe_b64decode(key)
    signing, encryption = secret[:16], secret[16:]
    vector = hmac.digest(signing, content, "sha256")[:16]
    padder, cipher = PKCS7(128).padder(), Cipher(AES(encryption), CBC(vector)).encryptor()
    padded = padder.update(content) + padder.finalize()
    token = b"\x80" + bytes(8) + vector + cipher.update(padded) + cipher.finalize()
    return base64.urlsafe_b64encode(token + hmac.digest(signing, token, "sha256"))


def unseal(path: Path, key: str, folder: Path | None = None) -> Sealed:
    """Open a sealed file; where `folder` is given, only if it is the one whose hash lies there.

    Raises:
        InputError: the file cannot be read, is not the one sealed for the folder, or the key does not open it.
    """
    token = read_bytes(path, _LARGEST, "a sealed file")
    if folder is not None:
        _check_hash(path, token, folder)
    try:
        packed = Fernet(key.strip().encode()).decrypt(token)
    except (InvalidToken, ValueError, UnicodeError) as error:
        raise InputError(f"{path}: the key does not open it; give the key that `blind make` printed") from error
    with zipfile.ZipFile(io.BytesIO(packed)) as archive:
        # what opens was encrypted by `seal`, so its form need not be checked
        head = json.loads(archive.read(_LABELS))
        unseen: dict[str, dict[str, bytes]] = {}
        for entry in archive.namelist():
            if entry.startswith("unseen/"):
                case, _, name = entry.removeprefix("unseen/").partition("/")
                if problem := explain_bad_name(case) or explain_bad_name(name):
                    raise InputError(f"{path}: the file {entry!r} in it {problem}")
                unseen.setdefault(case, {})[name] = archive.read(entry)
    return Sealed(head["cases"], unseen, head["made"])


def _check_hash(path: Path, token: bytes, folder: Path) -> None:
    note = folder / SEAL
    if not note.is_file():
        raise InputError(f"{note}: not there; {folder} is not a folder that `blind make` finished")
    words = read_bytes(note, _LARGEST, "a seal").decode(errors="replace").split()  # "sha256 HASH"
    if len(words) < 2 or words[1] != hashlib.sha256(token).hexdigest():
        raise InputError(f"{path}: is not the file sealed for {folder} (its SHA-256 differs from {SEAL})")
