"""A run as a film of one field: an animated GIF by Pillow, and an MP4 where there is an ffmpeg."""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

import numpy as np
from PIL import Image

import talus_style as style
from talus_moments import advance, chosen_snapshots
from talus_sections import Painter
from talus_units import words

RATE = 10            # frames of the film in a second
FAST, SLOW = 8, 3    # length of the film for all fast parts of the run together, and for all slow ones [s]
BEFORE = 1           # of which the slow part before the first fast one has at most so much: little can be seen in it [s]
FLUENT = 4           # snapshots that appear in a second of the film where the soil is fast, at the least
FEW = 20             # snapshots while soil is fast: fewer are no film
CREEP = 0.1          # soil is slow below this share of the largest speed of the run
FIRST, LAST = 3, 15  # more frames for which the start and the end stand still
RESOLUTION = 100     # of the frames, dots per inch
GIF_PIXELS, GIF_BYTES, GIF_COLOURS = 900, 2_900_000, 192  # largest width and size [bytes] of the GIF


def paces(snapshots):
    """For each interval between two snapshots (how much faster than the run its film is, is it shortened?). What lies between the first and
    the last fast interval of a stage has one factor, the same in all stages. What is before and after is shortened further, so that all slow
    parts together take no longer than SLOW, and what is before the first fast one no longer than BEFORE."""
    pairs = list(zip(snapshots, snapshots[1:]))
    time = np.array([after.time - before.time for before, after in pairs])
    way = np.array([advance(before, after) for before, after in pairs])
    speed = np.divide(way, time, out=np.zeros_like(way), where=time > 0)
    stage = np.array([after.stage for _, after in pairs])
    fast = np.zeros(len(pairs), bool)
    for name in set(stage):
        moving = np.flatnonzero((stage == name) & (speed >= CREEP * speed.max()))
        if len(moving):
            fast[moving[0]:moving[-1] + 1] = True
    common = round_factor(max(time[fast].sum() / FAST, FLUENT * time[fast].mean() if fast.any() else 0.0))
    first = np.flatnonzero(fast)[0] if fast.any() else 0
    starts = np.flatnonzero([k == 0 or stage[k] != stage[k - 1] or fast[k] != fast[k - 1] for k in range(len(pairs))])
    result = []
    for part in np.split(np.arange(len(pairs)), starts[1:]):
        early = part[0] < first
        own = round_factor(time[part].sum() * ((~fast[:first]).sum() / BEFORE if early else (~fast[first:]).sum() / (SLOW - BEFORE)) / len(part))
        shortened = bool(not fast[part[0]] and own > common)
        result += [(own if shortened else common, shortened)] * len(part)
    return result


def round_factor(factor):
    """The nearest of 1, 2, 5, 10, 20, 50 ... and of 1/2, 1/5, 1/10 ...; 1 for no time at all."""
    if factor <= 0:
        return 1.0
    power = int(np.floor(np.log10(factor)))
    steps = [step * 10.0**power if power >= 0 else step / 10.0**-power for step in (1, 2, 5, 10)]
    return min(steps, key=lambda step: abs(np.log(factor / step)))


def pace_in_words(factor, shortened):
    """'real time', '5 × real time', '1/20 of real time'; stages that are shortened say so."""
    text = "real time" if factor == 1 else f"{factor:,.0f} × real time" if factor > 1 else f"1/{1 / factor:,.0f} of real time"
    return f"shortened: {text}" if shortened else text


def timeline(snapshots):
    """[(snapshot, number of frames for which it is shown, pace in words)]: at each frame the last snapshot whose time has come. Snapshots that
    lie closer together than frames are left out."""
    pace = paces(snapshots)
    steps = [(after.time - before.time) / factor for before, after, (factor, _) in zip(snapshots, snapshots[1:], pace)]
    at = np.concatenate([[0.0], np.cumsum(steps)])  # when each appears [s of the film]
    frames = np.floor(RATE * at + 1e-9).astype(int)
    ends = np.append(frames[1:], frames[-1] + 1)
    film = []
    for k, (snapshot, count) in enumerate(zip(snapshots, ends - frames)):
        count += (k == 0) * FIRST + (k == len(snapshots) - 1) * LAST
        if count > 0:
            film.append((snapshot, int(count), pace_in_words(*pace[k - 1]) if k else ""))
    return film


def tell_of_few(snapshots):
    """A sentence on a run whose motion has fewer snapshots than a film shows fluently; empty where it has enough."""
    pairs = [(before, after) for (before, after), (_, shortened) in zip(zip(snapshots, snapshots[1:]), paces(snapshots)) if not shortened]
    count, time = len(pairs), sum(after.time - before.time for before, after in pairs)
    if count >= FEW or not time:
        return ""
    stages = dict.fromkeys(after.stage for _, after in pairs)
    wanted = float(f"{time / (RATE * FAST / 2):.1g}")
    return (f"the soil moves in {count} of the snapshots only, in the stage{'s' * (len(stages) > 1)} {', '.join(stages)}: a run with output.interval = {wanted:g} s "
            "shows its motion fluently")


def draw_movies(results, fields, folder, log=False):
    """movie_FIELD.gif of each field, and movie_FIELD.mp4 where there is an ffmpeg; says on standard output what it wrote and what not. Raises
    ValueError where there is nothing that moves, OSError where `folder` cannot be written."""
    snapshots = chosen_snapshots(results, count=len(results.snapshots))
    if len(snapshots) < 2:
        raise ValueError(f"{results.folder} contains {len(snapshots)} snapshot with soil, and a film needs two; a smaller "
                         "output.interval writes more")
    film, few = timeline(snapshots), tell_of_few(snapshots)
    painter = Painter(results, snapshots, RESOLUTION)
    ffmpeg = shutil.which("ffmpeg")
    for field in fields:
        painter.count_from(field, snapshots)
        colours = painter.colours(field, snapshots, log)
        with temporary_folder(folder) as place:
            frames = []
            for n, (snapshot, count, pace) in enumerate(film, 1):
                progress(f"{field}: picture {n} of {len(film)}")
                path = pathlib.Path(place) / f"{n:05}.png"
                frames.append((painter.frame(field, colours, snapshot, pace, path), count))
            progress(f"{field}: GIF")
            written = [write_gif(frames, folder / f"movie_{field}.gif")]
            if ffmpeg:
                progress(f"{field}: MP4")
                written.append(write_mp4(ffmpeg, frames, folder / f"movie_{field}.mp4"))
            progress("")
        seconds = sum(count for _, count in frames) / RATE
        print(f"{words(field)}: {len(frames)} of {len(results.snapshots)} snapshots in {seconds:.1f} s; wrote " + ", ".join(filter(None, written)))
    if few:
        print(few)
    if not ffmpeg:
        print("no MP4 was written, since there is no ffmpeg; on Debian, apt-get install ffmpeg installs it")


def temporary_folder(folder):
    """A folder for the frames in the folder of the film, so that one that cannot be written is found before anything is drawn."""
    try:
        folder.mkdir(exist_ok=True)
        return tempfile.TemporaryDirectory(prefix=".movie_", dir=folder)
    except OSError as error:
        raise OSError(f"cannot write the film in {folder}: {error.strerror}") from error


def progress(text):
    """One line of a terminal that is written again and again; nothing where nobody watches."""
    if sys.stderr.isatty():
        print(f"\r\033[K{text}", end="", file=sys.stderr, flush=True)


def write_gif(frames, path):
    """Writes the frames with one palette, so that colours do not flicker, as wide as GIF_BYTES allows. Returns what it wrote in words."""
    wide = GIF_PIXELS
    for _ in range(5):
        images = [reduced(frame, wide) for frame, _ in frames]
        palette = palette_of([images[k] for k in sorted({0, len(images) // 2, len(images) - 1})])
        images = [image.quantize(palette=palette, dither=Image.Dither.NONE) for image in images]
        draft = frames[0][0].with_suffix(".gif")
        images[0].save(draft, save_all=True, append_images=images[1:], duration=[count * 1000 // RATE for _, count in frames], loop=0,
                       comment=style.program().encode())
        size = draft.stat().st_size
        if size <= GIF_BYTES:
            break
        wide = int(0.97 * wide * (GIF_BYTES / size) ** 0.5)
    os.replace(draft, path)
    return f"{path} ({size / 1e6:.2g} MB, {images[0].width} x {images[0].height} pixels)"


def reduced(path, wide):
    with Image.open(path) as image:
        return image.convert("RGB").resize((wide, round(image.height * wide / image.width)), Image.Resampling.LANCZOS)


def palette_of(images):
    """The palette of some images one below the other."""
    sheet = Image.new("RGB", (images[0].width, images[0].height * len(images)))
    for k, image in enumerate(images):
        sheet.paste(image, (0, k * image.height))
    palette = sheet.quantize(GIF_COLOURS)
    colours = np.array(palette.getpalette()[:3 * GIF_COLOURS]).reshape(-1, 3)
    colours[colours.min(axis=1) > 247] = 255  # Pillow compares colours in steps of four, so that white would be nearly white
    palette.putpalette(colours.ravel().tolist())
    return palette


def write_mp4(ffmpeg, frames, path):
    """Writes the frames as H.264, which every browser and slide program shows. Returns what it wrote in words; "" with a message on standard
    error where ffmpeg fails."""
    place = frames[0][0].parent
    lines = [f"file '{frame.name}'\nduration {count / RATE}" for frame, count in frames]
    (place / "frames.txt").write_text("\n".join([*lines, f"file '{frames[-1][0].name}'"]) + "\n")  # the last one twice, or its duration is lost
    draft = place / "movie.mp4"
    command = [ffmpeg, "-nostdin", "-loglevel", "error", "-y", "-f", "concat", "-i", "frames.txt", "-vf",
               "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white", "-r", str(RATE), "-c:v", "libx264", "-crf", "18", "-pix_fmt", "yuv420p",
               "-movflags", "+faststart", "-metadata", f"comment={style.program()}", draft.name]
    done = subprocess.run(command, cwd=place, capture_output=True, text=True)
    if done.returncode:
        print(f"no MP4 was written, since ffmpeg failed: {done.stderr.strip()}", file=sys.stderr)
        return ""
    size = draft.stat().st_size
    os.replace(draft, path)
    return f"{path} ({size / 1e6:.2g} MB)"
