#if UNITY_5_3_OR_NEWER
using UnityEngine;

namespace Palpate
{
    /// <summary>Moves a tool by the mouse: left, right, up and down in the picture's plane, the wheel toward and away.
    /// The right button closes the jaws. Needs Unity's Input Manager (the old input system).</summary>
    [AddComponentMenu("Palpate/Mouse Hand")]
    public sealed class MouseHand : HapticDeviceBehaviour
    {
        [Tooltip("Metres per unit of the axes Mouse X and Mouse Y.")]
        public float metresPerUnit = 0.001f;

        [Tooltip("Metres per notch of the wheel.")]
        public float metresPerNotch = 0.002f;

        private PointerDevice pointer;

        public override IHapticDevice Open(Simulation simulation, int hand)
        {
            pointer = new PointerDevice(simulation, hand);
            return pointer;
        }

        private void Update()
        {
            if (pointer == null) return;
#if ENABLE_LEGACY_INPUT_MANAGER
            Vec3d target = pointer.Target;
            target.X += metresPerUnit * Input.GetAxis("Mouse X");
            target.Y += metresPerNotch * Input.mouseScrollDelta.y;
            target.Z += metresPerUnit * Input.GetAxis("Mouse Y");
            pointer.SetTarget(target, Input.GetMouseButton(1) ? 0.0 : 1.0);
#else
            Debug.LogError("MouseHand needs Unity's Input Manager: Project Settings, Player, Active Input Handling");
            enabled = false;
#endif
        }
    }
}
#endif
