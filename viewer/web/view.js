// The browser's side of a view: it shows what it is sent and sends what mouse, fingers and keys do. `config` has the keys
// that do something and the help; `send` takes messages as viewer/web/messages.py knows them.
function startView(root, config, send) {
  root.classList.add("pbr-viewer");
  root.tabIndex = 0;
  root.dataset.lmSuppressShortcuts = "true";  // JupyterLab's keys are not for those who are here
  const add = (name, kind = "div") => root.appendChild(Object.assign(document.createElement(kind), { className: name }));
  const canvas = add("picture", "canvas"), line = add("line"), left = add("side left"), right = add("side right");
  const status = add("words status"), message = add("words message"), help = add("help");
  canvas.setAttribute("role", "img");
  status.setAttribute("role", "status");
  canvas.width = canvas.height = 0;
  help.hidden = line.hidden = left.hidden = right.hidden = true;
  for (const [group, lines] of config.help) {
    const section = help.appendChild(document.createElement("section"));
    section.appendChild(document.createElement("h2")).textContent = group;
    const list = section.appendChild(document.createElement("dl"));
    for (const [keys, text] of lines) {
      list.appendChild(document.createElement("dt")).textContent = keys;
      list.appendChild(document.createElement("dd")).textContent = text;
    }
  }
  const keys = new Set(config.keys), fingers = new Map();
  let words = {}, pinch = null, moved = null, wheel = null, frame = 0;
  let held = null;  // where the picture was when a drag began: another client may give it another shape meanwhile

  // Where the picture is in the element, in its pixels: all of its height or all of its width.
  function place() {
    const [width, height] = [root.clientWidth, root.clientHeight];
    const scale = canvas.width ? Math.min(width / canvas.width, height / canvas.height) : 0;
    const size = scale ? [canvas.width * scale, canvas.height * scale] : [width, height];
    return { left: (width - size[0]) / 2, top: (height - size[1]) / 2, width: size[0], height: size[1] };
  }
  function at(event) {
    const box = root.getBoundingClientRect(), inside = held ?? place();
    return { x: event.clientX - box.left - inside.left, y: event.clientY - box.top - inside.top,
             width: Math.max(inside.width, 1), height: Math.max(inside.height, 1) };
  }
  function hold(where) {
    held = where;
    root.classList.toggle("held", Boolean(held));
  }
  function write() {
    const box = place(), isSplit = typeof words.split === "number" && canvas.width > 0;
    status.textContent = words.status ?? "";
    message.textContent = words.message ?? "";
    message.classList.toggle("error", Boolean(words.isError));
    line.hidden = left.hidden = right.hidden = !isSplit;
    if (!isSplit) return;
    const x = `${box.left + words.split * box.width}px`;
    Object.assign(line.style, { left: x, top: `${box.top}px`, height: `${box.height}px` });
    left.style.left = right.style.left = x;
    [left.textContent, right.textContent] = words.sides;
  }
  // A screen shows one frame at a time, so what happens between two of them is sent at once.
  function flush() {
    cancelAnimationFrame(frame);
    frame = 0;
    if (moved) send({ kind: "move", ...moved });
    if (wheel) {
      const within = (notches) => Math.min(Math.max(notches, -100), 100);
      send({ kind: "wheel", ...wheel, dx: within(wheel.dx), dy: within(wheel.dy) });
    }
    moved = wheel = null;
  }
  const soon = () => { frame ||= requestAnimationFrame(flush); };
  function scroll(event, dx, dy, shift) {
    const before = wheel && wheel.shift === shift ? wheel : { dx: 0, dy: 0 };
    wheel = { ...at(event), dx: before.dx + dx, dy: before.dy + dy, shift };
    soon();
  }
  const middle = ([a, b]) => ({ clientX: (a.clientX + b.clientX) / 2, clientY: (a.clientY + b.clientY) / 2 });
  const apart = ([a, b]) => Math.max(Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY), 1);

  const events = {
    pointerdown(event) {
      if (!help.hidden) return;
      root.focus({ preventScroll: true });
      root.setPointerCapture(event.pointerId);
      flush();
      if (event.pointerType === "touch") {
        fingers.set(event.pointerId, event);
        if (fingers.size === 2) {
          send({ kind: "cancel" });  // of the first finger's drag
          pinch = apart([...fingers.values()]);
        }
        if (fingers.size > 1) return;
      }
      hold(place());
      send({ kind: "press", ...at(event), is_left: event.button === 0, shift: event.shiftKey });
    },
    pointermove(event) {
      if (fingers.has(event.pointerId)) fingers.set(event.pointerId, event);
      if (fingers.size === 2) {
        const now = apart([...fingers.values()]);
        scroll(middle([...fingers.values()]), 0, Math.log(pinch / now) / Math.log(0.88), false);
        pinch = now;
      } else if (fingers.size < 2) {
        moved = at(event);
        const over = typeof words.split === "number" && Math.abs(moved.x - words.split * moved.width) <= 6;
        root.classList.toggle("on-split", over && !held);
        if (event.buttons) soon();
      }
    },
    pointerup(event) {
      const wasPinch = fingers.size > 1;
      flush();
      fingers.delete(event.pointerId);
      if (!wasPinch) send({ kind: "release", ...at(event), is_left: event.button === 0, shift: event.shiftKey });
      hold(null);
    },
    pointercancel(event) {
      fingers.delete(event.pointerId);
      hold(null);
      send({ kind: "cancel" });
    },
    wheel(event) {
      if (!help.hidden || !root.matches(":focus")) return;  // else it scrolls the page
      event.preventDefault();
      const notch = [100, 3, 1][event.deltaMode];
      scroll(event, -event.deltaX / notch, -event.deltaY / notch, event.shiftKey);
    },
    contextmenu(event) {
      if (help.hidden) event.preventDefault();
    },
    keydown(event) {
      if (event.altKey || event.metaKey) return;
      const letter = /^[a-z]$/i.test(event.key) ? event.key.toUpperCase() : null;
      const other = event.code.replace(/^Key|^Digit/, "").replace(/^Numpad([0-9])$/, "KP_$1").toUpperCase();
      const name = (event.ctrlKey ? "Ctrl+" : "") + (event.shiftKey ? "Shift+" : "") + (letter ?? other);
      if (name === "ESCAPE" && !help.hidden) help.hidden = true;
      else if (!keys.has(name) || event.ctrlKey && letter || /^F1?2$/.test(name)) return;  // those are the browser's
      else if (name === "H" || name === "F1") help.hidden = !help.hidden;
      else if (name === "S") save();
      else if (!event.repeat) send({ kind: "key", key: name });
      event.preventDefault();
      event.stopPropagation();
    },
  };
  function save() {
    canvas.toBlob((blob) => {
      const link = Object.assign(document.createElement("a"), { href: URL.createObjectURL(blob) });
      link.download = `${String(words.name ?? "").replace(/[^\p{L}\p{N} ._-]/gu, "_") || "picture"}.png`;
      link.click();
      URL.revokeObjectURL(link.href);
    });
  }
  for (const [name, listener] of Object.entries(events)) root.addEventListener(name, listener, { passive: false });
  function tellSize() {
    const ratio = window.devicePixelRatio || 1;
    if (root.clientWidth && root.clientHeight)
      send({ kind: "size", width: Math.max(root.clientWidth * ratio, 1), height: Math.max(root.clientHeight * ratio, 1) });
    write();
  }
  const observer = new ResizeObserver(tellSize);
  observer.observe(root);

  return {
    tellSize,
    // Shows the words, and the picture if `bytes` has one, and then says so: the next ones come after that.
    async show(newWords, bytes) {
      if (bytes) {
        const picture = await createImageBitmap(new Blob([bytes])), [width, height] = newWords.size;
        if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
        canvas.getContext("2d").drawImage(picture, 0, 0, width, height);  // one that moves may be smaller
        picture.close();
      }
      words = newWords;
      canvas.setAttribute("aria-label", words.name ?? "");
      write();
      send({ kind: "shown" });
    },
    say(text) {
      words = { ...words, message: text, isError: true };
      write();
    },
    stop() {
      observer.disconnect();
      cancelAnimationFrame(frame);
      for (const [name, listener] of Object.entries(events)) root.removeEventListener(name, listener);
      root.replaceChildren();
    },
  };
}
