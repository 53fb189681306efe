// A view in a cell of a notebook: what startView sends and is sent goes by the messages of the widget. The model may be
// shown several times at once, and each of its views has an identity of its own.
export default {
  render({ model, el }) {
    const config = model.get("config"), [width, height] = config.size;
    const id = `${Date.now().toString(36)}-${Math.random().toString(36).slice(2)}`;
    const root = el.appendChild(document.createElement("div"));
    Object.assign(root.style, { width: "100%", maxWidth: `${width}px`, aspectRatio: `${width} / ${height}` });
    const send = (message) => model.send({ view: id, message });
    const view = startView(root, config, send);
    const receive = (content, buffers) => {
      if (content.view === id) view.show(content.words, buffers[0] ?? null);
    };
    model.on("msg:custom", receive);
    send({ kind: "hello" });
    view.tellSize();
    return () => {
      send({ kind: "bye" });
      model.off("msg:custom", receive);
      view.stop();
    };
  },
};
