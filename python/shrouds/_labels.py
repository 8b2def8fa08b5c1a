"""Every label of a volume measured."""

from __future__ import annotations

import json
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._arrays import Affine, Inside, Place, Placed, Volume, placed
from ._shroud import Shroud, named

if TYPE_CHECKING:
    from typing_extensions import Unpack

#: Layers of outside voxels that are kept around a body, and around a face between two of them.
_MARGIN = 2
_CONTACT_MARGIN = 8


def measure_labels(
    values: ArrayLike | Volume,
    *,
    labels: Iterable[int] | None = None,
    components: bool = False,
    contacts: bool = False,
    settings: dict[str, Any] | None = None,
    threads: int | None = None,
    **place: Unpack[Place],
) -> dict[str, list[dict[str, Any]]]:
    """Shroud and measure every label of a volume, as ``shrouds measure --labels all`` does.

    Parameters
    ----------
    values
        An array of whole numbers, or a :class:`Volume`.
    labels
        Those that are wanted; all but 0 if not given.
    components
        Whether every connected component is measured alone.
    contacts
        Whether the areas in which labels touch each other are measured.
    settings
        Those of :func:`shroud` by their names; the preset is ``"exact"`` unless it is given, and ``"default"`` for
        contacts.
    threads
        Number of threads; all there are if not given.
    **place
        Where the volume lies: ``spacing``, ``origin``, ``affine`` and ``axes`` of :func:`shroud`.

    Returns
    -------
    dict
        ``rows``: one for each label or component, with ``label``, ``component`` (from 1, or None) and what
        :func:`measure` tells. ``contacts``: ``label``, ``other`` and ``area`` of each pair that touches.

    Examples
    --------
    >>> import numpy as np, shrouds
    >>> labels = np.zeros((14, 14, 14), np.uint8)
    >>> labels[3:7, 3:11, 3:11], labels[7:11, 3:11, 3:11] = 4, 9
    >>> found = shrouds.measure_labels(labels, contacts=True)
    >>> [row["label"] for row in found["rows"]]
    [4, 9]
    >>> [(one["label"], one["other"], round(one["area"])) for one in found["contacts"]]
    [(4, 9, 63)]
    """
    array = placed(values, **place)
    if array.values.dtype.kind not in "bui":
        raise ValueError(f"the array holds {array.values.dtype}, but labels are whole numbers")
    wanted = np.unique(array.values).tolist() if labels is None else sorted(set(labels))
    chosen = {name: value for name, value in (settings or {}).items() if value is not None}
    rows = []
    for label in wanted:
        if label:
            bits = _native.Volume(array.values, array.rows, [int(label)], None, threads)
            rows += _rows(bits, int(label), components, chosen, threads)
    found = _contacts(array, wanted, named(chosen), threads) if contacts else []
    return {"rows": rows, "contacts": found}


def _rows(
    bits: _native.Volume,
    label: int,
    components: bool,
    settings: dict[str, Any],
    threads: int | None,
) -> list[dict[str, Any]]:
    given = named({"preset": "exact", **settings})
    whole = settings.get("border") == "open"
    parts = bits.components(settings.get("faces", "separate")) if components else [bits]
    rows = []
    for number, part in enumerate(parts, 1):
        body = part if whole else part.cropped(_MARGIN)
        place = Inside(body, "zyx", "index", "unknown", str(label))
        made = Shroud(place, 0.0, _native.shroud(body, given, None, threads, None))
        found = json.loads(made._kept().measure(made._mesh(), None, threads))
        rows.append({"label": label, "component": number if components else None, **found})
    return rows


def _contacts(
    array: Placed, wanted: list[int], given: list[tuple[str, str]], threads: int | None
) -> list[dict[str, Any]]:
    found = []
    for (label, other), (low, high) in sorted(_faces(array.values).items()):
        if label in wanted and other in wanted:
            start = np.maximum(low - _CONTACT_MARGIN, 0)
            ranges = tuple(map(slice, start, high + _CONTACT_MARGIN))
            rows = _moved(array.rows, start[::-1])
            one, two = (
                _native.Volume(array.values[ranges], rows, [each], None, threads)
                for each in (label, other)
            )
            area = _native.contact_area(one, two, given, threads)
            found.append({"label": label, "other": other, "area": area})
    return found


def _moved(rows: Affine, index: NDArray[np.int64]) -> Affine:
    """An affine from indices of a part that begins at an index."""
    matrix = np.array(rows)
    matrix[:, 3] += matrix[:, :3] @ index
    return tuple((float(a), float(b), float(c), float(d)) for a, b, c, d in matrix)


def _faces(values: NDArray[Any]) -> dict[tuple[int, int], NDArray[np.int64]]:
    """For each two labels that touch, the box of the voxels that do: first indices and those after the last."""
    boxes: dict[tuple[int, int], NDArray[np.int64]] = {}
    for axis in range(3):
        step = np.eye(3, dtype=int)[axis]
        before = values[tuple(slice(None, -1 if n else None) for n in step)]
        after = values[tuple(slice(n, None) for n in step)]
        places = np.argwhere((before != after) & (before != 0) & (after != 0))
        where = tuple(places.T)
        ends = np.sort(np.stack([before[where], after[where]], axis=1), axis=1)
        pairs, numbers = np.unique(ends, axis=0, return_inverse=True)
        for number, (one, other) in enumerate(pairs.tolist()):
            own = places[numbers.ravel() == number]
            box = np.array([own.min(axis=0), own.max(axis=0) + 1 + step])
            known = boxes.get((one, other), box)
            low, high = np.minimum(known[0], box[0]), np.maximum(known[1], box[1])
            boxes[one, other] = np.array([low, high])
    return boxes
